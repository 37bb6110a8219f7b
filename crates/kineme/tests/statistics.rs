//! Order statistics and the agreement of partitions, against values worked out by hand or published.

use kineme::math::statistics::{
    agreement, mean_and_deviation, median, noise_as_singletons, quantile,
};

fn check(found: f64, wanted: f64, what: &str) {
    assert!(
        (found - wanted).abs() < 1e-9,
        "{what}: {found} not {wanted}"
    );
}

#[test]
fn partitions_agree_as_the_indices_say() {
    type Case = (&'static str, &'static [usize], &'static [usize], f64, f64);
    let cases: [Case; 6] = [
        ("equal", &[0, 0, 1, 1], &[0, 0, 1, 1], 1.0, 1.0),
        ("names do not count", &[0, 0, 1, 1], &[7, 7, 3, 3], 1.0, 1.0),
        // Two pairs against one pair and two singles: 2 * (1 - 1/3) / (3 - 2/3); ln 2 over the mean of ln 2 and 1.5 ln 2.
        (
            "one pair split",
            &[0, 0, 1, 1],
            &[0, 0, 1, 2],
            4.0 / 7.0,
            0.8,
        ),
        ("crossed", &[0, 0, 1, 1], &[0, 1, 0, 1], -0.5, 0.0),
        ("all against one", &[0, 0, 0, 0], &[0, 1, 2, 3], 0.0, 0.0),
        ("one cluster each", &[0, 0, 0], &[5, 5, 5], 1.0, 1.0),
    ];
    for (what, a, b, ari, nmi) in cases {
        for found in [agreement(a, b), agreement(b, a)] {
            check(found.ari, ari, what);
            check(found.nmi, nmi, what);
        }
    }
}

#[test]
fn hubert_and_arabie_worked_through() {
    // Contingency table 1 1 0 / 1 2 1 / 0 0 4 (Yeung and Ruzzo 2001, who print .313):
    // 7 pairs together, 13 in rows, 14 in columns, of 45.
    let table = [[1, 1, 0], [1, 2, 1], [0, 0, 4]];
    let (mut a, mut b) = (vec![], vec![]);
    for (i, row) in table.iter().enumerate() {
        for (j, &count) in row.iter().enumerate() {
            a.extend(std::iter::repeat_n(i, count));
            b.extend(std::iter::repeat_n(j, count));
        }
    }
    let expected = 13.0 * 14.0 / 45.0;
    check(
        agreement(&a, &b).ari,
        (7.0 - expected) / (13.5 - expected),
        "adjusted Rand index",
    );
}

#[test]
fn unclustered_items_stand_alone() {
    let labels = noise_as_singletons(&[Some(1), None, Some(0), None, Some(1)]);
    assert_eq!(labels, [1, 2, 0, 3, 1]);
    assert_eq!(noise_as_singletons(&[None, None]), [0, 1]);
}

#[test]
fn quantiles_lie_between_order_statistics() {
    let values = [4.0, f64::NAN, 1.0, 3.0, 2.0];
    for (q, wanted) in [
        (0.0, 1.0),
        (0.5, 2.5),
        (1.0, 4.0),
        (0.25, 1.75),
        (-3.0, 1.0),
    ] {
        check(quantile(&values, q).expect("a value"), wanted, "quantile");
    }
    assert_eq!(median(&[f64::NAN]), None);
    let (mean, deviation) = mean_and_deviation(&[1.0, 2.0, 3.0, 4.0]);
    check(mean, 2.5, "mean");
    check(deviation, (5.0f64 / 3.0).sqrt(), "deviation");
    assert_eq!(mean_and_deviation(&[3.0]), (3.0, 0.0));
}
