//! Meshes: where the nodes lie.

/// What lies between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Span {
    /// A part of an arc, of this length of the scaled time.
    Interval { arc: usize, length: f64 },
    /// The border between `arc` and the next one, where both nodes are at the same time.
    Switch { arc: usize },
}

/// Nodes on arcs that are each of length 1 in the scaled time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mesh {
    pub spans: Vec<Span>,
}

impl Mesh {
    /// `intervals` equal intervals on each arc.
    pub fn uniform(intervals: &[usize]) -> Self {
        Self::from_lengths(intervals.iter().map(|&count| vec![1.0 / count as f64; count]))
    }

    /// From the lengths of the intervals of each arc.
    pub fn from_lengths(arcs: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let mut spans = Vec::new();
        for (arc, lengths) in arcs.into_iter().enumerate() {
            if arc > 0 {
                spans.push(Span::Switch { arc: arc - 1 });
            }
            spans.extend(lengths.into_iter().map(|length| Span::Interval { arc, length }));
        }
        Self { spans }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.spans.len() + 1
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.spans.iter().filter(|span| matches!(span, Span::Interval { .. })).count()
    }

    /// Number of arcs.
    pub fn arcs(&self) -> usize {
        self.spans.len() - self.intervals() + 1
    }

    /// The arc that node i belongs to.
    pub fn arc_of_node(&self, i: usize) -> usize {
        match self.spans.get(i).or(self.spans.last()) {
            Some(&(Span::Interval { arc, .. } | Span::Switch { arc })) => arc,
            None => 0,
        }
    }

    /// Neighbouring intervals taken together, so that no arc has more than `most`; and the lengths that each is made of, none
    /// for a switch.
    pub fn coarsened(&self, most: usize) -> (Self, Vec<Vec<f64>>) {
        let mut arcs: Vec<Vec<f64>> = vec![Vec::new(); self.arcs()];
        for span in &self.spans {
            if let Span::Interval { arc, length } = *span {
                arcs[arc].push(length);
            }
        }
        let (mut parts, mut taken) = (Vec::new(), Vec::new());
        for (arc, lengths) in arcs.iter().enumerate() {
            if arc > 0 {
                parts.push(Vec::new());
            }
            let chunks = lengths.chunks(lengths.len().div_ceil(most).max(1));
            parts.extend(chunks.clone().map(<[f64]>::to_vec));
            taken.push(chunks.map(|chunk| chunk.iter().sum()).collect());
        }
        (Self::from_lengths(taken), parts)
    }

    /// Intervals of these lengths in place of each one.
    pub fn cut(&self, parts: &[Vec<f64>]) -> Self {
        let mut arcs: Vec<Vec<f64>> = vec![Vec::new(); self.arcs()];
        for (span, parts) in self.spans.iter().zip(parts) {
            if let Span::Interval { arc, .. } = *span {
                arcs[arc].extend(parts);
            }
        }
        Self::from_lengths(arcs)
    }

    /// A mesh with about `intervals` intervals on which the errors are alike, when `errors` (one for each span, zero for
    /// a switch) grow with the power `order + 1` of the length.
    ///
    /// Neighbours differ by no more than what a fifth of the mean density asks for.
    pub fn equidistributed(&self, errors: &[f64], order: usize, intervals: usize) -> Self {
        let power = 1.0 / (order + 1) as f64;
        // Number of new intervals that fall into each old one, before scaling.
        let mut shares: Vec<f64> = errors.iter().map(|error| error.powf(power)).collect();
        let total: f64 = shares.iter().sum();
        let mean = if total > 0.0 { total / self.arcs() as f64 } else { 1.0 };
        for (share, span) in shares.iter_mut().zip(&self.spans) {
            if let Span::Interval { length, .. } = span {
                *share = share.max(0.2 * mean * length);
            }
        }
        let scale = intervals as f64 / shares.iter().sum::<f64>();
        let mut arcs: Vec<Vec<(f64, f64)>> = vec![Vec::new(); self.arcs()];
        for (share, span) in shares.iter().zip(&self.spans) {
            if let Span::Interval { arc, length } = *span {
                arcs[arc].push((length, share * scale));
            }
        }
        Self::from_lengths(arcs.iter().map(|parts| divide(parts)))
    }
}

/// Cuts parts with (length, share) into pieces of equal shares; at least three.
fn divide(parts: &[(f64, f64)]) -> Vec<f64> {
    let total: f64 = parts.iter().map(|part| part.1).sum();
    let pieces = (total.round() as usize).max(3);
    let (mut borders, mut before, mut position) = (vec![0.0], 0.0, 0.0);
    for &(length, share) in parts {
        while borders.len() < pieces {
            let wanted = total * borders.len() as f64 / pieces as f64;
            if wanted > before + share {
                break;
            }
            borders.push(position + length * (wanted - before) / share);
        }
        before += share;
        position += length;
    }
    while borders.len() < pieces {
        borders.push(position);
    }
    borders.push(1.0);
    borders.windows(2).map(|pair| pair[1] - pair[0]).filter(|&length| length > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::{Mesh, Span};

    #[test]
    fn what_is_taken_together_can_be_cut_again() {
        let mesh = Mesh::from_lengths([vec![0.1, 0.2, 0.3, 0.4], vec![0.5, 0.5]]);
        let (coarse, parts) = mesh.coarsened(3);
        assert_eq!((coarse.intervals(), coarse.arcs()), (4, 2));
        assert!(parts[2].is_empty() && parts[1] == [0.3, 0.4]);
        assert_eq!(coarse.cut(&parts), mesh);
    }

    #[test]
    fn intervals_gather_where_errors_are_large() {
        let mesh = Mesh::uniform(&[10, 5]);
        let errors: Vec<f64> =
            mesh.spans.iter().enumerate().map(|(i, _)| if i == 3 { 1.0 } else { 1e-6 }).collect();
        let fine = mesh.equidistributed(&errors, 4, 30);
        assert_eq!(fine.arcs(), 2);
        for arc in 0..2 {
            let lengths = fine.spans.iter().filter_map(|span| match *span {
                Span::Interval { arc: of, length } if of == arc => Some(length),
                _ => None,
            });
            assert!((lengths.sum::<f64>() - 1.0).abs() < 1e-12);
        }
        assert!((25..=35).contains(&fine.intervals()), "{}", fine.intervals());
        let shortest = fine.spans.iter().filter_map(|span| match *span {
            Span::Interval { length, .. } => Some(length),
            Span::Switch { .. } => None,
        });
        assert!(shortest.fold(1.0, f64::min) < 0.03);
    }
}
