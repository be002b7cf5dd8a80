//! Centrality correctors of a step ([`CentralitySettings`]).

use crate::barrier::longest_steps;
use crate::centrality::{CentralitySettings, set_targets};
use crate::iterate::Step;
use crate::solve::Solver;

impl Solver {
    /// Corrects the step for mu as long as that makes it longer. Whether it was corrected.
    pub(crate) fn correct_products(&mut self, mu: f64) -> bool {
        let CentralitySettings { correctors, longer, enough, products, gain, descent } =
            self.settings.centrality;
        let tau = self.settings.barrier.part_of_way(mu);
        let lengths = |solver: &Self, step: &Step| {
            longest_steps(&solver.iterate, solver.newton.reciprocals(), step, tau)
        };
        let mut reached = lengths(self, &self.step);
        if reached[0].min(reached[1]) >= enough || correctors == 0 {
            return false;
        }
        let slope = self.slope(mu);
        let mut is_corrected = false;
        for _ in 0..correctors {
            if reached[0].min(reached[1]) >= enough {
                break;
            }
            let wanted = reached.map(|length| (length + longer).min(1.0));
            std::mem::swap(&mut self.targets, &mut self.targets_before);
            let Self { layout, iterate, step, blocks, newton, correction, targets, targets_before, .. } =
                self;
            let range = products.map(|part| part * mu);
            set_targets(targets, targets_before, (iterate, step, newton.reciprocals()), wanted, range);
            let is_found = newton
                .corrected_step(layout, iterate, blocks, (targets, targets_before), (step, correction))
                .is_ok();
            let found = lengths(self, &self.correction);
            let [before, after, most] = [reached, found, wanted].map(|lengths| lengths[0] + lengths[1]);
            let is_longer = found[0] >= reached[0] && found[1] >= reached[1];
            std::mem::swap(&mut self.step, &mut self.correction);
            let gains = is_found && is_longer && after - before >= gain * (most - before);
            if !(gains && (slope >= 0.0 || self.slope(mu) <= descent * slope)) {
                std::mem::swap(&mut self.step, &mut self.correction);
                std::mem::swap(&mut self.targets, &mut self.targets_before);
                break;
            }
            (reached, is_corrected) = (found, true);
        }
        is_corrected
    }
}
