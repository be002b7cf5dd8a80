//! Nodes that a problem names, and those where a guess crosses something narrow.

use super::crossings::{Room, graded};
use super::division::with_added;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::problem::narrow::Narrow;

impl<D> Interior<D> {
    /// These nodes with those at the knots of references, at the times of this motion. References with more
    /// knots than `most` have none: they are integrated across their knots
    /// ([`crate::direct::points::panels`]). A knot that is closer than this to a node is there.
    pub fn with_knots(&self, nodes: Vec<f64>, most: usize, closest: f64) -> Vec<f64> {
        let (end, start) = (self.spline.duration(), self.running.references.start);
        let inside = self.knots.iter().map(|knot| knot - start).filter(|&time| time > 0.0 && time < end);
        let places: Vec<f64> = inside.map(|time| self.spline.place_of(time)).collect();
        if places.is_empty() || places.len() > most {
            return nodes;
        }
        with_added(nodes, places, closest)
    }

    /// These nodes, those at the knots of references, and graded ones where this motion crosses the
    /// transition of dry friction, at most about `most` of them: those of a first mesh. What else is narrow
    /// bends a motion where it is: a guess does not know that.
    pub fn seeded(&self, most: usize) -> Vec<f64> {
        self.with_crossings(&self.crossed.friction(), most)
    }

    /// The same where this motion, which is solved, crosses the transition of dry friction or a speed of a
    /// motor.
    pub fn crossed(&self, most: usize) -> Vec<f64> {
        self.with_crossings(&self.crossed.of_rates(), most)
    }

    fn with_crossings(&self, narrow: &Narrow, most: usize) -> Vec<f64> {
        let closest = constants::CLOSEST * constants::NARROWEST;
        let mesh = &self.spline.mesh;
        let (mut room, mut added) = (Room::default(), Vec::new());
        for k in 0..if narrow.has_places() { mesh.intervals() } else { 0 } {
            let (places, _) = room.find(narrow, &self.spline, None, k);
            if added.len() + places.len() > most {
                break;
            }
            added.extend(graded(places).into_iter().map(|x| mesh.nodes[k] + x * mesh.width(k)));
        }
        self.with_knots(with_added(mesh.nodes.clone(), added, closest), most, closest)
    }
}
