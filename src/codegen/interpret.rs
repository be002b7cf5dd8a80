//! Evaluation of a program, step by step.

use super::error::CodegenError;
use super::program::Program;
use super::record::{Id, Node};
use crate::error::check_length;
use crate::scalar::Scalar;

impl Program {
    /// Evaluates the program step by step: all arguments one after the other, all results likewise, each row
    /// by row.
    ///
    /// Much slower than generated code; the tests compare generated code with it. `work` is resized to the
    /// number of nodes; nothing else is allocated.
    ///
    /// # Errors
    /// [`CodegenError::Eval`] with [`EvalError::WrongLength`](crate::EvalError::WrongLength) where `inputs`
    /// or `outputs` does not have the length of all arguments or all results.
    pub fn evaluate<S: Scalar>(
        &self,
        inputs: &[S],
        outputs: &mut [S],
        work: &mut Vec<S>,
    ) -> Result<(), CodegenError> {
        check_length("inputs", inputs, self.inputs())?;
        check_length("outputs", outputs, self.outputs())?;
        work.clear();
        for node in self.nodes() {
            let value = self.step(*node, inputs, work);
            work.push(value);
        }
        let entries = self.results().iter().flat_map(|result| &result.entries);
        outputs.iter_mut().zip(entries).for_each(|(output, id)| *output = work[id.index()]);
        Ok(())
    }

    /// The value of one step.
    fn step<S: Scalar>(&self, node: Node, inputs: &[S], work: &[S]) -> S {
        let of = |id: Id| work[id.index()];
        match node {
            Node::Constant(value) => S::from_f64(value),
            Node::Input(k) => inputs[k as usize],
            Node::Neg(a) => -of(a),
            Node::Add(a, b) => of(a) + of(b),
            Node::Sub(a, b) => of(a) - of(b),
            Node::Mul(a, b) => of(a) * of(b),
            Node::Div(a, b) => of(a) / of(b),
            Node::MulAdd(a, b, c) => of(a).mul_add(of(b), of(c)),
            Node::MulSub(a, b, c) => of(a).mul_add(of(b), -of(c)),
            Node::NegMulAdd(a, b, c) => (-of(a)).mul_add(of(b), of(c)),
            Node::Sqrt(a) => of(a).sqrt(),
            Node::Sin(a) => of(a).sin_cos().0,
            Node::Cos(a) => of(a).sin_cos().1,
            Node::Exp(a) => of(a).exp(),
            Node::ExpM1(a) => of(a).exp_m1(),
            // Comparisons are evaluated by the selections that use them.
            Node::Less(..) => S::zero(),
            Node::Select(mask, a, b) => match self.nodes()[mask.index()] {
                Node::Less(x, y) => S::select(of(x).less(of(y)), of(a), of(b)),
                _ => of(b),
            },
        }
    }
}
