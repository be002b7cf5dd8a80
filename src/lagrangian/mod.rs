//! The state equation in (q, v).
