//! Functions for CasADi, which loads them from this module by name: no compiler, no calls through Python.
//!
//! CasADi finds a function and its derivatives by the names of symbols. There is a fixed number of them
//! (`symbols`), each a slot that holds a function while anything in CasADi refers to it (`slots`). `layout`
//! derives the five functions that CasADi asks for from one description, `family` evaluates them, `models`
//! has the descriptions, `python` is what `costate.casadi` calls.

mod family;
mod layout;
mod models;
mod python;
mod slots;
mod symbols;

pub use python::{_CasadiSlot, _casadi_calls, _casadi_refusal, _casadi_slots};
