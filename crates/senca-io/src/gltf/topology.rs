//! From the seven primitive modes to separate triangles, lines and dots (glTF 2.0, section 3.7.2.1).

/// What one primitive draws, as vertex numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Elements {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) lines: Vec<[u32; 2]>,
    pub(super) dots: Vec<u32>,
}

impl Elements {
    /// The elements that `corners` make in `mode`; `None` for a mode that glTF does not know.
    /// Triangles of strips and fans that name a vertex twice only join pieces and are left out.
    pub(super) fn expand(mode: u64, corners: &[u32]) -> Option<Self> {
        let mut elements = Self::default();
        match mode {
            0 => elements.dots = corners.to_vec(),
            1 => elements.lines = corners.chunks_exact(2).map(|c| [c[0], c[1]]).collect(),
            2 => elements.lines = line_loop(corners),
            3 => elements.lines = corners.windows(2).map(|c| [c[0], c[1]]).collect(),
            4 => elements.triangles = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            5 => elements.triangles = strip(corners),
            6 => elements.triangles = fan(corners),
            _ => return None,
        }
        Some(elements)
    }

    /// Corners left over at the end of a list in `mode`.
    pub(super) fn left_over(mode: u64, corners: usize) -> usize {
        match mode {
            1 => corners % 2,
            4 => corners % 3,
            _ => 0,
        }
    }

    /// Number of elements of all kinds.
    pub(super) fn len(&self) -> usize {
        self.triangles.len() + self.lines.len() + self.dots.len()
    }

    /// Keeps the elements whose vertices all satisfy `keep`.
    pub(super) fn retain(&mut self, keep: impl Fn(u32) -> bool) {
        self.triangles.retain(|t| t.iter().all(|&v| keep(v)));
        self.lines.retain(|l| l.iter().all(|&v| keep(v)));
        self.dots.retain(|&d| keep(d));
    }

    /// Every vertex number, to be read or changed.
    pub(super) fn vertices_mut(&mut self) -> impl Iterator<Item = &mut u32> {
        let triangles = self.triangles.iter_mut().flatten();
        triangles.chain(self.lines.iter_mut().flatten()).chain(&mut self.dots)
    }

    /// Every vertex number.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u32> {
        let triangles = self.triangles.iter().flatten();
        triangles.chain(self.lines.iter().flatten()).chain(&self.dots).copied()
    }
}

fn line_loop(corners: &[u32]) -> Vec<[u32; 2]> {
    let mut lines: Vec<_> = corners.windows(2).map(|c| [c[0], c[1]]).collect();
    if let [first, _, .., last] = *corners {
        lines.push([last, first]);
    }
    lines
}

/// Every second triangle is turned, so that all keep the winding of the first.
fn strip(corners: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(i, c): (usize, &[u32])| {
        if i.is_multiple_of(2) { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] }
    };
    corners.windows(3).enumerate().map(turned).filter(distinct).collect()
}

fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    let Some((&hub, rim)) = corners.split_first() else { return Vec::new() };
    rim.windows(2).map(|c| [c[0], c[1], hub]).filter(distinct).collect()
}

fn distinct(t: &[u32; 3]) -> bool {
    t[0] != t[1] && t[1] != t[2] && t[2] != t[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(mode: u64, corners: &[u32]) -> Elements {
        Elements::expand(mode, corners).expect("a known mode")
    }

    #[test]
    fn lists_are_cut_and_ends_left_out() {
        assert_eq!(expand(0, &[4, 5]).dots, [4, 5]);
        assert_eq!(expand(1, &[0, 1, 2, 3, 4]).lines, [[0, 1], [2, 3]]);
        assert_eq!(expand(4, &[0, 1, 2, 3]).triangles, [[0, 1, 2]]);
        assert_eq!((Elements::left_over(1, 5), Elements::left_over(4, 5)), (1, 2));
        assert!(Elements::expand(7, &[]).is_none());
    }

    #[test]
    fn loops_close_and_strips_do_not() {
        assert_eq!(expand(2, &[0, 1, 2]).lines, [[0, 1], [1, 2], [2, 0]]);
        assert_eq!(expand(2, &[0, 1]).lines, [[0, 1]]);
        assert_eq!(expand(3, &[0, 1, 2]).lines, [[0, 1], [1, 2]]);
        assert!(expand(2, &[3]).lines.is_empty());
    }

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(expand(5, &[0, 1, 2, 3, 4]).triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(expand(6, &[0, 1, 2, 3]).triangles, [[1, 2, 0], [2, 3, 0]]);
    }

    #[test]
    fn joints_of_strips_vanish() {
        assert_eq!(expand(5, &[0, 1, 2, 2, 5, 5, 6, 7]).triangles, [[0, 1, 2], [5, 7, 6]]);
    }
}
