//! Has no code: its manifest gives dependencies the features that all builds share.
