//! Answers to whole clips: cases computed by hand, and laws.

use kineme::evaluation::{
    Bootstrap, Confusion, Estimate, Judged, Scores, calibration_by_chance, differences,
    pooled_scores, scores,
};
use kineme::primitive::Posterior;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A clip among primitives, with the probabilities of these, rest and none.
fn clip(truth: Option<usize>, primitives: &[f64], rest: f64, none: f64, novelty: f64) -> Judged {
    Judged {
        truth,
        posterior: Posterior {
            primitives: primitives.to_vec(),
            rest,
            none,
        },
        novelty,
    }
}

/// Five clips of two primitives and none of them.
fn five() -> Vec<Judged> {
    vec![
        clip(Some(0), &[0.8, 0.1], 0.0, 0.1, 0.2),
        clip(Some(0), &[0.3, 0.6], 0.0, 0.1, 0.5),
        clip(Some(1), &[0.1, 0.9], 0.0, 0.0, 0.3),
        clip(None, &[0.2, 0.2], 0.1, 0.5, 0.9),
        clip(None, &[0.5, 0.1], 0.0, 0.4, 0.4),
    ]
}

/// A recogniser that is sure, of three primitives and none: `answers` beside `truths`.
fn sure(truths: &[Option<usize>], answers: &[Option<usize>]) -> Vec<Judged> {
    let pairs = truths.iter().zip(answers);
    pairs
        .map(|(&truth, answer)| {
            let mut primitives = vec![0.0; 3];
            if let Some(a) = answer {
                primitives[*a] = 1.0;
            }
            let none = f64::from(u8::from(answer.is_none()));
            clip(truth, &primitives, 0.0, none, 1.0 + none)
        })
        .collect()
}

fn judged(clips: &[Judged]) -> Scores {
    scores(clips, &Bootstrap::default()).expect("scores")
}

/// The seven values, in the order of the fields.
fn values(s: &Scores) -> [Option<f64>; 7] {
    [
        Some(s.accuracy),
        Some(s.balanced_accuracy),
        Some(s.macro_f1),
        s.log_loss,
        s.calibration_error,
        s.auroc,
        s.unknowns_found,
    ]
    .map(|e| e.map(|e: Estimate| e.value))
}

#[track_caller]
fn check(what: &str, found: [Option<f64>; 7], wanted: [Option<f64>; 7]) {
    for (i, (f, w)) in found.iter().zip(wanted).enumerate() {
        let same = match (f, w) {
            (Some(f), Some(w)) => (f - w).abs() < 1e-12,
            (f, w) => f.is_none() && w.is_none(),
        };
        assert!(same, "{what}, measure {i}: found {f:?}, wanted {w:?}");
    }
}

#[test]
fn measures_are_what_a_hand_computes() {
    let losses: f64 = [0.8, 0.3, 0.9, 0.6, 0.4]
        .iter()
        .map(|p: &f64| -p.ln())
        .sum();
    let wanted = [
        Some(3.0 / 5.0),
        Some((0.5 + 1.0 + 0.5) / 3.0),
        Some((0.5 + 2.0 / 3.0 + 2.0 / 3.0) / 3.0),
        Some(losses / 5.0),
        Some((0.2 + 0.6 + 0.1 + 0.0) / 5.0),
        Some(5.0 / 6.0),
        Some(1.0 / 2.0),
    ];
    check("five clips", values(&judged(&five())), wanted);

    // A positive and a negative of one novelty: a tie counts half, and is not found.
    let tied = [
        clip(Some(0), &[1.0, 0.0], 0.0, 0.0, 0.5),
        clip(None, &[0.0, 0.0], 1.0, 0.0, 0.5),
    ];
    let sure = -0.0_f64;
    let wanted = [1.0, 1.0, 1.0, sure, 0.0, 0.5, 0.0].map(Some);
    check("a tie", values(&judged(&tied)), wanted);

    // Twenty positives: the farthest may be lost and 95 % are kept.
    let mut many: Vec<Judged> = (0..20)
        .map(|i| clip(Some(0), &[1.0], 0.0, 0.0, f64::from(i)))
        .collect();
    many.push(clip(None, &[0.0], 0.0, 1.0, 18.5));
    many.push(clip(None, &[0.0], 0.0, 1.0, 18.0));
    let found = judged(&many).unknowns_found.map(|e| e.value);
    assert_eq!(found, Some(0.5));
}

#[test]
fn what_is_undefined_is_none() {
    let [.., auroc, found] = values(&judged(&five()[..3]));
    assert_eq!((auroc, found), (None, None), "no negatives");
    let [.., auroc, found] = values(&judged(&five()[3..]));
    assert_eq!((auroc, found), (None, None), "no positives");
    let binary = [clip(Some(0), &[1.0, 1.0], 0.0, 0.0, 0.0)];
    let [accuracy, .., loss, calibration, _, _] = values(&judged(&binary));
    assert_eq!(
        (accuracy, loss, calibration),
        (Some(1.0), None, None),
        "binary"
    );
}

#[test]
fn nonsense_is_refused() {
    let good = clip(Some(0), &[1.0, 0.0], 0.0, 0.0, 0.0);
    for (what, bad) in [
        (
            "a truth that is no primitive",
            clip(Some(2), &[1.0, 0.0], 0.0, 0.0, 0.0),
        ),
        ("other primitives", clip(Some(0), &[1.0], 0.0, 0.0, 0.0)),
        ("above 1", clip(Some(0), &[1.5, 0.0], 0.0, 0.0, 0.0)),
        (
            "no probability",
            clip(Some(0), &[f64::NAN, 0.0], 0.0, 0.0, 0.0),
        ),
        ("no novelty", clip(Some(0), &[1.0, 0.0], 0.0, 0.0, f64::NAN)),
    ] {
        let refused = scores(&[good.clone(), bad], &Bootstrap::default());
        assert!(refused.is_err_and(|e| e.is_invalid()), "{what}");
    }
    assert!(scores(&[], &Bootstrap::default()).is_err());
    for (draws, level) in [(0, 0.95), (10, 0.0), (10, 1.0), (10, f64::NAN)] {
        let bootstrap = Bootstrap {
            draws,
            seed: 0,
            level,
        };
        assert!(scores(&five(), &bootstrap).is_err(), "{bootstrap:?}");
    }
    assert!(differences(&five(), &five()[1..], &Bootstrap::default()).is_err());
    assert!(Confusion::new(1, &five()).is_err());
}

#[test]
fn a_perfect_recogniser_has_it_all_and_a_constant_one_its_share() {
    let truths = [Some(0), Some(1), Some(2), None].repeat(25);
    let perfect = judged(&sure(&truths, &truths));
    check(
        "perfect",
        values(&perfect),
        [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0].map(Some),
    );
    assert_eq!((perfect.accuracy.low, perfect.accuracy.high), (1.0, 1.0));
    let constant = sure(&truths, &[Some(1); 100]);
    let worst = -(1e-15_f64.ln());
    let share = [0.25, 0.25, 0.4 / 4.0, 0.75 * worst, 0.75, 0.5, 0.0];
    check("constant", values(&judged(&constant)), share.map(Some));
}

#[test]
fn the_order_of_clips_is_irrelevant() {
    let mut clips = five();
    let wanted = values(&judged(&clips));
    for _ in 0..5 {
        clips.rotate_left(2);
        clips.swap(0, 3);
        check("reordered", values(&judged(&clips)), wanted);
    }
}

#[test]
fn confusion_counts_truths_by_answers() {
    let confusion = Confusion::new(2, &five()).expect("a confusion");
    for (truth, answer, wanted) in [
        (Some(0), Some(0), 1),
        (Some(0), Some(1), 1),
        (Some(0), None, 0),
        (Some(1), Some(1), 1),
        (None, None, 1),
        (None, Some(0), 1),
        (None, Some(1), 0),
    ] {
        assert_eq!(
            confusion.count(truth, answer),
            wanted,
            "{truth:?} {answer:?}"
        );
    }
    assert_eq!(confusion.counts.iter().sum::<usize>(), 5);
}

#[test]
fn intervals_cover_the_truth_about_as_often_as_they_say() {
    let mut random = Pcg64::seed_from_u64(7);
    let (trials, chance) = (200, 0.7);
    let mut covered = 0;
    for seed in 0..trials {
        let answers: Vec<Option<usize>> = (0..80)
            .map(|_| Some(usize::from(random.random_range(0.0..1.0) >= chance)))
            .collect();
        let bootstrap = Bootstrap {
            draws: 200,
            seed,
            ..Bootstrap::default()
        };
        let found = scores(&sure(&[Some(0); 80], &answers), &bootstrap).expect("scores");
        let Estimate { value, low, high } = found.accuracy;
        assert!(low <= value && value <= high);
        covered += u32::from((low..=high).contains(&chance));
    }
    let share = f64::from(covered) / trials as f64;
    assert!(
        (0.89..=0.985).contains(&share),
        "{share} of intervals of 95 %"
    );
}

#[test]
fn draws_depend_on_the_seed_alone() {
    let with = |seed| {
        let bootstrap = Bootstrap {
            seed,
            draws: 9,
            ..Bootstrap::default()
        };
        scores(&five(), &bootstrap).expect("scores")
    };
    assert_eq!(with(3), with(3));
    assert_ne!(with(3).log_loss, with(4).log_loss);
}

#[test]
fn differences_are_paired() {
    let truths: Vec<Option<usize>> = [Some(0), Some(1), None].repeat(40);
    // Both are wrong on the same third; the other also on five more.
    let mut one = truths.clone();
    for answer in one.iter_mut().step_by(3) {
        *answer = Some(2);
    }
    let mut other = one.clone();
    for answer in other.iter_mut().skip(1).step_by(24) {
        *answer = Some(2);
    }
    let (one, other) = (sure(&truths, &one), sure(&truths, &other));
    let bootstrap = Bootstrap::default();
    let d = differences(&one, &other, &bootstrap)
        .expect("differences")
        .accuracy;
    let alone = judged(&one).accuracy;
    assert!((d.value - 5.0 / 120.0).abs() < 1e-12, "{d:?}");
    assert!(
        d.low > 0.0 && d.high - d.low < 0.6 * (alone.high - alone.low),
        "{d:?} {alone:?}"
    );
    let back = differences(&other, &one, &bootstrap)
        .expect("differences")
        .accuracy;
    assert!((back.value + d.value).abs() < 1e-12 && (back.low + d.high).abs() < 1e-12);
    let same = differences(&one, &one, &bootstrap).expect("differences");
    check("itself", values(&same), [Some(0.0); 7]);
}

/// A clip of two primitives, the first answered with probability `confidence`.
fn answered(confidence: f64, is_right: bool) -> Judged {
    let truth = usize::from(!is_right);
    clip(Some(truth), &[confidence, 1.0 - confidence], 0.0, 0.0, 0.0)
}

/// The mean of |K / n - p| where K is binomial.
fn mean_deviation(n: usize, p: f64) -> f64 {
    let log_odds = (p / (1.0 - p)).ln();
    let mut log_probability = n as f64 * (1.0 - p).ln();
    let mut sum = 0.0;
    for k in 0..=n {
        sum += log_probability.exp() * (k as f64 / n as f64 - p).abs();
        log_probability += ((n - k) as f64 / (k + 1) as f64).ln() + log_odds;
    }
    sum
}

#[test]
fn by_chance_equal_confidences_err_as_a_binomial_share_does() {
    for (n, p) in [(1, 0.75), (10, 0.6), (118, 0.55), (400, 0.9)] {
        let clips: Vec<Judged> = (0..n).map(|i| answered(p, i % 2 == 0)).collect();
        let alone: Vec<&[Judged]> = clips.chunks(1).collect();
        let chance = calibration_by_chance(&alone, &Bootstrap::default())
            .expect("drawn")
            .expect("probabilities");
        let wanted = mean_deviation(n, p);
        // Six standard errors of 2,000 draws; one draw deviates by about as much as the mean.
        let slack = 6.0 * wanted / 2000f64.sqrt();
        assert!(
            (chance.mean - wanted).abs() < slack,
            "{n} of {p}: {} for {wanted}",
            chance.mean
        );
        assert!(chance.high >= chance.mean, "{n} of {p}: {chance:?}");
        // Were the answers right or wrong by halves, it would change nothing: what is drawn is not what was measured.
        let wrong: Vec<Judged> = (0..n).map(|_| answered(p, false)).collect();
        let alone: Vec<&[Judged]> = wrong.chunks(1).collect();
        let same = calibration_by_chance(&alone, &Bootstrap::default()).expect("drawn");
        assert_eq!(same, Some(chance), "{n} of {p}");
    }
}

#[test]
fn by_chance_the_certain_do_not_err_and_the_binary_have_none() {
    let certain = [answered(1.0, true), answered(1.0, false)];
    let alone: Vec<&[Judged]> = certain.chunks(1).collect();
    let chance = calibration_by_chance(&alone, &Bootstrap::default())
        .expect("drawn")
        .expect("probabilities");
    assert_eq!((chance.mean, chance.high), (0.0, 0.0));
    let binary = [clip(Some(0), &[1.0, 1.0], 0.0, 0.0, 0.0)];
    let none = calibration_by_chance(&[&binary], &Bootstrap::default()).expect("drawn");
    assert_eq!(none, None);
    assert!(calibration_by_chance(&[], &Bootstrap::default()).is_err());
    let never = Bootstrap {
        draws: 0,
        ..Bootstrap::default()
    };
    assert!(calibration_by_chance(&alone, &never).is_err());
}

#[test]
fn errors_above_chance_are_as_rare_as_the_level_says() {
    // Exactly right probabilities from .5 to 1, two hundred times sixty clips.
    let mut random = Pcg64::seed_from_u64(5);
    let few = Bootstrap {
        draws: 200,
        ..Bootstrap::default()
    };
    let above = (0..200).filter(|_| {
        let clips: Vec<Judged> = (0..60)
            .map(|_| {
                let confidence = 0.5 + 0.5 * random.random::<f64>();
                answered(confidence, random.random::<f64>() < confidence)
            })
            .collect();
        let alone: Vec<&[Judged]> = clips.chunks(1).collect();
        let chance = calibration_by_chance(&alone, &few)
            .expect("drawn")
            .expect("probabilities");
        let measured = judged(&clips).calibration_error.expect("probabilities");
        measured.value > chance.high
    });
    let above = above.count();
    assert!((2..=22).contains(&above), "{above} of 200, 10 expected");
}

#[test]
fn answers_to_one_clip_are_resampled_together() {
    let clips: Vec<Judged> = (0..60).map(|i| answered(0.7, i % 3 > 0)).collect();
    let single = scores(&clips, &Bootstrap::default()).expect("scores");
    let alone: Vec<&[Judged]> = clips.chunks(1).collect();
    let pooled = pooled_scores(&alone, &Bootstrap::default()).expect("scores");
    assert_eq!(single, pooled, "one answer a clip");
    // Each answer four times: nothing more is known.
    let four: Vec<Vec<Judged>> = clips.iter().map(|c| vec![c.clone(); 4]).collect();
    let four: Vec<&[Judged]> = four.iter().map(Vec::as_slice).collect();
    let pooled = pooled_scores(&four, &Bootstrap::default()).expect("scores");
    check("four times", values(&single), values(&pooled));
    for (one, other) in [
        (single.accuracy.low, pooled.accuracy.low),
        (single.accuracy.high, pooled.accuracy.high),
    ] {
        assert!((one - other).abs() < 1e-12, "{one} and {other}");
    }
    let chance = |clips: &[&[Judged]]| {
        calibration_by_chance(clips, &Bootstrap::default())
            .expect("drawn")
            .expect("probabilities")
    };
    assert!((chance(&alone).mean - chance(&four).mean).abs() < 1e-12);
}
