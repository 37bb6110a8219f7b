//! Names of files, as short as they still differ.

/// The names without the folders that all of them lie in, and without the extension that all of them have.
///
/// ```
/// let short = kineme_report::short_names(&["set/walk/a.bvh", "set/run/a.bvh"]);
/// assert_eq!(short, ["walk/a", "run/a"]);
/// ```
pub fn short_names(names: &[&str]) -> Vec<String> {
    let Some(first) = names.first() else {
        return Vec::new();
    };
    let mut folder = first.rfind('/').map_or("", |at| &first[..=at]);
    while !names.iter().all(|name| name.starts_with(folder)) {
        let parent = folder.trim_end_matches('/').rfind('/');
        folder = parent.map_or("", |at| &folder[..=at]);
    }
    let file = first.rsplit('/').next().unwrap_or(first);
    // What is only an extension is a name.
    let extension = file
        .rfind('.')
        .filter(|at| *at > 0)
        .map_or("", |at| &file[at..]);
    let without = |name: &str| {
        let name = &name[folder.len()..];
        let stem = name.strip_suffix(extension)?;
        (!stem.is_empty() && !stem.ends_with('/')).then(|| stem.to_owned())
    };
    let short: Option<Vec<String>> = names.iter().map(|name| without(name)).collect();
    short.unwrap_or_else(|| {
        let names = names.iter().map(|name| name[folder.len()..].to_owned());
        names.collect()
    })
}

#[cfg(test)]
mod tests {
    use super::short_names;

    #[test]
    fn what_all_names_share_is_left_out() {
        for (names, expected) in [
            (vec!["a/b/x.amc", "a/b/y.amc"], vec!["x", "y"]),
            (vec!["a/b/x.amc", "a/c/x.amc"], vec!["b/x", "c/x"]),
            (
                vec!["a/bc/x.bvh", "a/bd/x.csv"],
                vec!["bc/x.bvh", "bd/x.csv"],
            ),
            (vec!["x.bvh", "a/y.bvh"], vec!["x", "a/y"]),
            (vec!["a/x.bvh"], vec!["x"]),
            (vec!["a/.bvh", "a/x.bvh"], vec![".bvh", "x.bvh"]),
            (vec!["walk", "run"], vec!["walk", "run"]),
            (
                vec!["caf\u{e9}/x.bvh", "caf\u{e8}/x.bvh"],
                vec!["caf\u{e9}/x", "caf\u{e8}/x"],
            ),
            (vec![], vec![]),
        ] {
            assert_eq!(short_names(&names), expected, "{names:?}");
        }
    }
}
