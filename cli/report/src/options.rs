//! What a report shows beside the motion.

use crate::models::LinkModel;

/// What a report shows beside the motion; nothing by default.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ReportOptions {
    /// The text of the problem file.
    pub source: String,
    /// How links look, as [`of_urdf`](crate::models::of_urdf) reads it; links without a model are capsules.
    pub models: Vec<LinkModel>,
}

impl ReportOptions {
    /// With the text of the problem file.
    #[must_use]
    pub fn with_source(self, source: impl Into<String>) -> Self {
        Self { source: source.into(), ..self }
    }

    /// With these models of links.
    #[must_use]
    pub fn with_models(self, models: Vec<LinkModel>) -> Self {
        Self { models, ..self }
    }
}
