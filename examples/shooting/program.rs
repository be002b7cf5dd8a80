//! The problem as a staged program: what `costate-nlp` asks for.
//!
//! States are unknowns of the nodes, controls those of the intervals. The equations of an interval are its
//! defects, whose multipliers are the costates; bounds are ranges of single unknowns.

use crate::curvature::{Curvature, Learnt, Model, Nodes};
use crate::problem::{NotEvaluated, Problem};
use costate::dynamics::Cost;
use costate::step::Step;
use costate_nlp::{Blocks, Element, Layout, Rows, StagedProblem, Values, Weights};
use nalgebra::DVector;

/// A problem with one kind of second derivatives.
pub struct Program<'a, M, L, F> {
    problem: &'a mut Problem<M, L, F>,
    curvature: Curvature,
    layout: Layout,
    /// Of each element the components that have bounds, by their place among its first unknowns: the states
    /// of a node, the controls of an interval.
    bounded: Vec<Vec<usize>>,
    bounds: [Vec<f64>; 2],
    learnt: Option<Learnt>,
    /// Multiple of the identity that is added in the states, from the next derivatives on.
    pub damping: f64,
    /// Why the last values could not be evaluated.
    pub failed: Option<NotEvaluated>,
}

impl<'a, M: Step<f64>, L: Cost<f64>, F: Cost<f64>> Program<'a, M, L, F> {
    pub fn new(problem: &'a mut Problem<M, L, F>, curvature: Curvature, damping: f64) -> Self {
        let (n, m, last) = (problem.states(), problem.controls(), problem.intervals);
        let nodes = (0..=last).map(|k| if problem.is_given(k) { 0 } else { n }).collect();
        let mut bounded = Vec::new();
        let mut bounds = [Vec::new(), Vec::new()];
        let layout = Layout::new(nodes, vec![m; last], 0).with_rows_of(|element| {
            let (own, equations) = match element {
                Element::Node(k) => ((!problem.is_given(k)).then_some(&problem.state_bounds), 0),
                Element::Interval(_) => (Some(&problem.control_bounds), n),
                Element::Ends => (None, 0),
            };
            let is_bounded =
                |i: &usize| own.is_some_and(|own| own.lower[*i].is_finite() || own.upper[*i].is_finite());
            let places: Vec<usize> = (0..own.map_or(0, |own| own.lower.len())).filter(is_bounded).collect();
            if let Some(own) = own {
                bounds[0].extend(places.iter().map(|&i| own.lower[i]));
                bounds[1].extend(places.iter().map(|&i| own.upper[i]));
            }
            let rows = Rows::new(equations, places.len());
            bounded.push(places);
            rows
        });
        Self { problem, curvature, layout, bounded, bounds, learnt: None, damping, failed: None }
    }

    /// The unknowns of a chain of nodes.
    pub fn point(&self, nodes: &[DVector<f64>]) -> Vec<f64> {
        let n = self.problem.states();
        let own = nodes.iter().enumerate().map(|(k, node)| {
            let first = if self.problem.is_given(k) { n } else { 0 };
            &node.as_slice()[first..]
        });
        own.flatten().copied().collect()
    }

    /// The chain of nodes of these unknowns.
    pub fn nodes(&self, point: &[f64]) -> Nodes {
        let Self { problem, layout, .. } = self;
        (0..=problem.intervals)
            .map(|k| {
                let given: &[f64] = match (k, &problem.end) {
                    (0, _) => &problem.start,
                    (k, Some(end)) if k == problem.intervals => end,
                    _ => &[],
                };
                let controls = if k < problem.intervals { &point[layout.private(k)] } else { &[] };
                DVector::from_vec([given, &point[layout.node(k)], controls].concat())
            })
            .collect()
    }

    /// The multipliers of the defects, one vector for each interval.
    pub fn costates(&self, equalities: &[f64]) -> Nodes {
        let own = |k| &equalities[self.layout.equalities_of(Element::Interval(k))];
        (0..self.problem.intervals).map(|k| DVector::from_column_slice(own(k))).collect()
    }

    /// The multipliers of the bounds, node by node: positive at an upper bound, negative at a lower one.
    pub fn multipliers(&self, ranges: &[f64]) -> Nodes {
        let Self { problem, layout, bounded, .. } = self;
        (0..=problem.intervals)
            .map(|k| {
                let mut own = DVector::zeros(problem.node_len(k));
                let of_interval = (k < problem.intervals).then_some((Element::Interval(k), problem.states()));
                for (element, first) in [(Element::Node(k), 0)].into_iter().chain(of_interval) {
                    let places = &bounded[layout.position(element)];
                    for (place, row) in places.iter().zip(layout.ranges_of(element)) {
                        own[first + place] = ranges[row];
                    }
                }
                own
            })
            .collect()
    }

    /// Of a chain of nodes; NaN where that is not known.
    pub fn largest_defect(&mut self, nodes: &[DVector<f64>]) -> f64 {
        let defects = self.problem.values(nodes).map(|values| values.defects);
        defects.map_or(f64::NAN, |defects| defects.iter().map(DVector::amax).fold(0.0, f64::max))
    }

    /// The model with the Hessians of this kind: `cost` is the factor of the cost.
    fn model(&mut self, nodes: Nodes, costates: &Nodes, cost: f64) -> Result<Model, NotEvaluated> {
        let mut model = self.problem.model(&nodes, costates, (self.curvature, cost))?;
        if self.curvature == Curvature::Damped {
            let n = self.problem.states();
            let blocks = model.hessian.iter_mut();
            blocks.for_each(|block| (0..n).for_each(|i| block[(i, i)] += cost * self.damping));
        }
        // In restoration there is no cost to learn of.
        if self.curvature == Curvature::Bfgs && cost > 0.0 {
            let learnt = self.learnt.get_or_insert_with(|| Learnt::new(&model));
            // Multipliers are about to be estimated where all of them are zero.
            if costates.iter().any(|costate| costate.amax() > 0.0) {
                learnt.learn(nodes, &model, costates);
            }
            model.hessian.clone_from(&learnt.hessian);
        }
        Ok(model)
    }
}

impl<M: Step<f64>, L: Cost<f64>, F: Cost<f64>> StagedProblem for Program<'_, M, L, F> {
    type Error = NotEvaluated;

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        self.bounds.each_ref().map(Vec::as_slice)
    }

    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), NotEvaluated> {
        let nodes = self.nodes(point);
        let found = match self.problem.values(&nodes) {
            Ok(found) => found,
            Err(error) => {
                // The solver takes a shorter step.
                self.failed = Some(error);
                values.cost = f64::NAN;
                return Ok(());
            }
        };
        self.failed = None;
        values.cost = found.cost;
        let defects = found.defects.iter().flatten();
        values.equalities.iter_mut().zip(defects).for_each(|(value, defect)| *value = *defect);
        for element in self.layout.elements() {
            let unknowns = match element {
                Element::Node(k) => &point[self.layout.node(k)],
                Element::Interval(k) => &point[self.layout.private(k)],
                Element::Ends => &[],
            };
            let places = &self.bounded[self.layout.position(element)];
            let rows = &mut values.ranges[self.layout.ranges_of(element)];
            rows.iter_mut().zip(places).for_each(|(value, place)| *value = unknowns[*place]);
        }
        Ok(())
    }

    fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), NotEvaluated> {
        let costates = self.costates(weights.equalities);
        let model = self.model(self.nodes(point), &costates, weights.cost)?;
        let (n, last) = (self.problem.states(), self.problem.intervals);
        for k in 0..=last {
            let (own, next) = (self.layout.node(k).len(), (k < last).then(|| self.layout.node(k + 1).len()));
            let (gradient, hessian) = (&model.gradient[k], &model.hessian[k]);
            let element = if k < last { Element::Interval(k) } else { Element::Node(k) };
            let block = blocks.of(element);
            // Of a given state there are no columns.
            let first = n - own;
            for i in first..gradient.len() {
                block.gradient[i - first] = gradient[i];
                (i..gradient.len()).for_each(|j| block.hessian[(i - first, j - first)] = hessian[(i, j)]);
            }
            if let Some(next) = next {
                let jacobian = &model.jacobian[k];
                for i in 0..n {
                    let row = block.equalities.row_mut(i);
                    (first..jacobian.ncols()).for_each(|j| row[j - first] = jacobian[(i, j)]);
                    if next > 0 {
                        row[jacobian.ncols() - first + i] = -1.0;
                    }
                }
            }
        }
        for element in self.layout.elements() {
            // Controls come after the states of their node.
            let first = match element {
                Element::Interval(k) => self.layout.node(k).len(),
                Element::Node(_) | Element::Ends => 0,
            };
            let block = blocks.of(element);
            for (i, place) in self.bounded[self.layout.position(element)].iter().enumerate() {
                block.ranges[(i, first + place)] = 1.0;
            }
        }
        Ok(())
    }
}
