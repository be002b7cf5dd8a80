//! The chain against dense factorisations and eigenvalues.

use super::{Chain, Inertia, Kept, Matrices};
use crate::blocks::Blocks;
use crate::condense::Condensed;
use crate::dense::Dense;
use crate::layout::{Element, Layout, Rows};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// A program with random blocks, and what is made of them.
struct Random {
    layout: Layout,
    blocks: Blocks,
    hessians: Vec<Dense>,
    diagonal: Vec<f64>,
    kept: Vec<Kept>,
}

impl Random {
    /// `definite`: Hessians are positive definite. Rank is lost where rows repeat.
    fn new(layout: Layout, seed: u64, definite: bool) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut number = || 2.0 * random.f64() - 1.0;
        let mut blocks = Blocks::new(&layout);
        let mut hessians = Vec::new();
        for element in layout.elements() {
            let block = blocks.of(element);
            let n = block.gradient.len();
            block.equalities.entries_mut().iter_mut().for_each(|entry| *entry = number());
            let half = DMatrix::from_fn(n, n, |_, _| number());
            let full = if definite {
                &half * half.transpose() + DMatrix::identity(n, n) * 0.01
            } else {
                &half + half.transpose()
            };
            let mut hessian = Dense::zeros(n, n);
            (0..n).for_each(|i| (i..n).for_each(|j| hessian[(i, j)] = full[(i, j)]));
            if element == Element::Ends && !layout.couples_ends() {
                hessian.entries_mut().fill(0.0);
            }
            hessians.push(hessian);
        }
        let diagonal = (0..layout.steps()).map(|_| 0.1 * (1.0 + number())).collect();
        Self { layout, blocks, hessians, diagonal, kept: Vec::new() }
    }

    /// With about half of the ranges as rows beside the equations, exactly or with entries on the diagonal.
    fn with_kept(mut self, seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let first = self.layout.steps() + self.layout.equalities();
        for element in self.layout.elements() {
            let mut kept = Kept::default();
            for row in self.layout.ranges_of(element) {
                if random.bool() {
                    continue;
                }
                kept.rows.push(first + row);
                kept.entries.extend((0..self.layout.width(element)).map(|_| 2.0 * random.f64() - 1.0));
                kept.diagonal.push([0.0, -1e-9, -0.5][random.usize(..3)]);
            }
            self.kept.push(kept);
        }
        self
    }

    /// Numbers of the ranges that are not rows.
    fn left_out(&self) -> Vec<usize> {
        let first = self.layout.steps() + self.layout.equalities();
        let is_kept = |row: &usize| self.kept.iter().any(|kept| kept.rows.contains(row));
        (first..first + self.layout.ranges()).filter(|row| !is_kept(row)).collect()
    }

    /// With ones for ranges that are not rows.
    fn dense(&self, dual: f64) -> DMatrix<f64> {
        let (n, m) = (self.layout.steps(), self.layout.equalities());
        let size = n + m + self.layout.ranges();
        let mut all = DMatrix::zeros(size, size);
        self.left_out().into_iter().for_each(|row| all[(row, row)] = 1.0);
        for (element, kept) in self.layout.elements().zip(&self.kept) {
            let columns: Vec<usize> = self.layout.unknowns(element).into_iter().flatten().collect();
            for (i, (&row, diagonal)) in kept.rows.iter().zip(&kept.diagonal).enumerate() {
                all[(row, row)] = *diagonal;
                for (j, &column) in columns.iter().enumerate() {
                    all[(row, column)] = kept.entries[i * columns.len() + j];
                    all[(column, row)] = all[(row, column)];
                }
            }
        }
        for (element, (block, hessian)) in
            self.layout.elements().zip(self.blocks.all().iter().zip(&self.hessians))
        {
            let columns: Vec<usize> = self.layout.unknowns(element).into_iter().flatten().collect();
            for (i, &row) in columns.iter().enumerate() {
                for (j, &column) in columns.iter().enumerate() {
                    all[(row, column)] += hessian[(i.min(j), i.max(j))];
                }
            }
            for (i, row) in self.layout.equalities_of(element).enumerate() {
                for (j, &column) in columns.iter().enumerate() {
                    all[(n + row, column)] += block.equalities[(i, j)];
                    all[(column, n + row)] += block.equalities[(i, j)];
                }
            }
        }
        (0..n).for_each(|i| all[(i, i)] += self.diagonal[i]);
        (n..n + m).for_each(|i| all[(i, i)] -= dual);
        all
    }

    fn factorise(&self, chain: &mut Chain, dual: f64) -> Inertia {
        self.factorise_unless(chain, dual, usize::MAX)
    }

    fn factorise_unless(&self, chain: &mut Chain, dual: f64, negative: usize) -> Inertia {
        let mut diagonal = self.diagonal.clone();
        diagonal.resize(self.layout.steps() + self.layout.equalities(), -dual);
        let jacobian = |element: usize| &self.blocks.all()[element].equalities;
        let matrices = Matrices { hessians: &self.hessians, jacobian, kept: &self.kept };
        chain.factorise_unless(matrices, &diagonal, negative)
    }
}

/// Few unknowns, or as many as fill several panels.
fn layouts() -> impl Strategy<Value = Layout> {
    prop_oneof![9 => sized_layouts(5, 4), 1 => sized_layouts(14, 8)]
}

fn sized_layouts(node: usize, private: usize) -> impl Strategy<Value = Layout> {
    let interval = (0..private, 0..3_usize, 0..4_usize);
    let nodes = (1..node, 0..3_usize);
    (proptest::collection::vec((interval, nodes), 1..6), 0..3_usize, 0..3_usize, any::<bool>()).prop_map(
        |(parts, shared, ends, cost)| {
            let sizes: Vec<usize> = parts.iter().map(|(_, (node, _))| *node).chain([2]).collect();
            let private = parts.iter().map(|((private, ..), _)| *private).collect();
            let mut layout = Layout::new(sizes, private, shared);
            for (k, ((_, few, many), (node, at_node))) in parts.iter().enumerate() {
                // Never more equations than unknowns.
                layout = layout.with_rows(Element::Node(k), Rows::new((*at_node).min(node / 2), 1));
                layout = layout.with_rows(Element::Interval(k), Rows::new((*few).min(node / 2), *many));
            }
            layout = layout.with_rows(Element::Ends, Rows::new(ends.min(2), 0));
            if cost { layout.with_cost_of_ends() } else { layout }
        },
    )
}

/// Numbers of eigenvalues of either sign; `None` where one of them is too small to have one.
fn inertia_of(matrix: &DMatrix<f64>) -> Option<Inertia> {
    let values = matrix.clone().symmetric_eigenvalues();
    let most = values.amax();
    let mut inertia = Inertia::default();
    for &value in values.iter() {
        if value.abs() < 1e-9 * most {
            return None;
        }
        if value > 0.0 { inertia.positive += 1 } else { inertia.negative += 1 }
    }
    Some(inertia)
}

proptest! {
    #[test]
    fn inertia_and_solutions_are_those_of_the_dense_matrix(
        layout in layouts(), seed in any::<u64>(), definite in any::<bool>(), keeps in any::<bool>(),
        dual in prop::sample::select(vec![0.0, 1e-3]),
    ) {
        let random = Random::new(layout, seed, definite);
        let random = if keeps { random.with_kept(seed) } else { random };
        let matrix = random.dense(dual);
        let left_out = random.left_out();
        let rows = random.layout.equalities() + random.layout.ranges() - left_out.len();
        let ranges = |element| random.layout.ranges_of(element).len();
        let mut chain = Chain::new(&random.layout, ranges, rows > 0);
        // Twice: nothing is left of the first.
        random.factorise(&mut chain, dual + 1.0);
        let most = rows;
        let early = random.factorise_unless(&mut chain, dual, most);
        let found = random.factorise(&mut chain, dual);
        let is_same = early == found;
        prop_assert!(is_same || (found.negative > most && early.negative > most));
        let Some(mut expected) = inertia_of(&matrix) else { return Ok(()) };
        expected.positive -= left_out.len();
        if rows == 0 && expected.negative > 0 {
            // Pivots in their order tell that it is not definite, no more.
            prop_assert!(found.negative > 0);
            return Ok(());
        }
        prop_assert_eq!(found, expected);
        let mut right = DVector::from_fn(matrix.nrows(), |i, _| (0.7 + i as f64).sin());
        left_out.into_iter().for_each(|row| right[row] = 0.0);
        let mut x = right.as_slice().to_vec();
        chain.solve(&mut x);
        let residual = (&matrix * DVector::from_vec(x.clone()) - right).amax();
        // Pivots above the threshold bound the growth of the elements; the rest is the condition.
        let size = matrix.amax() * x.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        prop_assert!(residual < 1e-9 * size, "{} of {}", residual, size);
    }

    #[test]
    fn equations_that_repeat_others_are_found(layout in layouts(), seed in any::<u64>()) {
        let mut random = Random::new(layout, seed, true);
        let layout = random.layout.clone();
        let mut repeated = 0;
        for element in layout.elements() {
            let rows = layout.rows(element).equalities;
            let block = random.blocks.of(element);
            if rows == 2 {
                let first = block.equalities.row(0).to_vec();
                block.equalities.row_mut(1).iter_mut().zip(&first).for_each(|(to, from)| *to = -2.0 * from);
                repeated += 1;
            }
        }
        let matrix = random.dense(0.0);
        let values = matrix.clone().symmetric_eigenvalues();
        let zeros = values.iter().filter(|value| value.abs() < 1e-10 * values.amax()).count();
        if zeros != repeated {
            // Other equations depend on each other by chance.
            return Ok(());
        }
        let mut chain = Chain::new(&layout, |_| 0, true);
        let found = random.factorise(&mut chain, 0.0);
        prop_assert_eq!(found.zero, repeated);
        prop_assert_eq!(found.positive, layout.steps());
        prop_assert!(chain.zeros().iter().all(|&row| row >= layout.steps()));
        // A consistent right-hand side is solved.
        let x = DVector::from_fn(matrix.nrows(), |i, _| (0.7 + i as f64).sin());
        let right = &matrix * x;
        let mut solved = right.as_slice().to_vec();
        chain.solve(&mut solved);
        let size = matrix.amax() * solved.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let residual = (&matrix * DVector::from_vec(solved) - right).amax();
        prop_assert!(residual < 1e-8 * size, "{} of {}", residual, size);
    }
}

/// Why rows and columns are scaled: equations that depend on all of the node that follows find pivots where
/// they stand beside Hessians of their own size; beside far larger ones they would wait until the end.
#[test]
fn equations_do_not_wait_beside_large_hessians() {
    let mut layout = Layout::uniform(40, 6, 2, 0);
    for k in 0..40 {
        layout = layout.with_rows(Element::Interval(k), Rows::new(5, 0));
    }
    let largest_front = |factor: f64, is_scaled: bool| {
        let mut random = Random::new(layout.clone(), 11, true);
        let hessians = random.hessians.iter_mut().flat_map(|hessian| hessian.entries_mut());
        hessians.chain(&mut random.diagonal).for_each(|entry| *entry *= factor);
        let mut chain = Chain::new(&layout, |_| 0, true);
        let inertia = if is_scaled {
            for (element, hessian) in layout.elements().zip(&random.hessians) {
                random.blocks.of(element).hessian = hessian.clone();
            }
            let units = &mut random.blocks.units;
            [&mut units.steps, &mut units.equalities].into_iter().for_each(|units| units.fill(1.0));
            let mut condensed = Condensed::new(&layout, |_| 0);
            condensed.set(&layout, &random.blocks, &[]);
            let none = vec![0.0; layout.steps() + layout.equalities()];
            chain.factorise(condensed.matrices(), &none)
        } else {
            random.factorise(&mut chain, 0.0)
        };
        assert_eq!([inertia.positive, inertia.negative], [layout.steps(), layout.equalities()]);
        chain.stages.iter().map(|stage| stage.factors.rows.len()).max().unwrap()
    };
    // Two nodes, what is private, the equations; and those that wait.
    let most = 6 + 2 + 5 + 6 + 5;
    let fronts = [(1.0, false), (1e8, true), (1e-8, true)].map(|(factor, is)| largest_front(factor, is));
    assert!(fronts.iter().all(|front| *front <= most), "{fronts:?}");
    assert!(largest_front(1e8, false) > 2 * most);
}
