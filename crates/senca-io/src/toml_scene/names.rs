//! Hints for misspelt names.

/// The candidate that `name` was probably meant to be: the nearest within a third of its length
/// (one to three edits), the first of several.
pub(super) fn nearest<'c>(name: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let allowed = (name.chars().count() / 3).clamp(1, 3);
    let near = candidates.into_iter().take(1000).map(|candidate| (edits(name, candidate), candidate));
    near.filter(|&(edits, _)| edits <= allowed)
        .min_by_key(|&(edits, _)| edits)
        .map(|(_, candidate)| candidate)
}

/// Number of characters to insert, remove, replace or swap with their neighbour to get from one to
/// the other (optimal string alignment), in either case. Names above 64 characters count as far.
fn edits(a: &str, b: &str) -> usize {
    let fold = |s: &str| s.chars().take(65).map(|c| c.to_ascii_lowercase()).collect::<Vec<_>>();
    let (a, b) = (fold(a), fold(b));
    if a.len().max(b.len()) > 64 {
        return usize::MAX;
    }
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

/// `"a", "b", "c"`, at most thirty of them.
pub(super) fn quoted_list(names: &[&str]) -> String {
    let mut list: Vec<String> = names.iter().take(30).map(|name| format!("\"{name}\"")).collect();
    if names.len() > list.len() {
        list.push(format!("and {} more", names.len() - list.len()));
    }
    list.join(", ")
}

/// ` - did you mean "gold"?`, or which names there are, or that there are none.
pub(super) fn hint(name: &str, defined: &[&str]) -> String {
    match nearest(name, defined.iter().copied()) {
        Some(meant) => format!("; did you mean \"{meant}\"?"),
        None if defined.is_empty() => "; none is".to_owned(),
        None => format!("; defined are {}", quoted_list(defined)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_not() {
        assert_eq!(nearest("gld", ["silver", "gold"]), Some("gold"));
        assert_eq!(nearest("raduis", ["radii", "radius"]), Some("radius"));
        assert_eq!(nearest("Gold", ["gold"]), Some("gold"));
        assert_eq!(nearest("copper", ["gold", "silver"]), None);
        assert_eq!(nearest(&"a".repeat(1000), ["a"]), None);
    }
}
