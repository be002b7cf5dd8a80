//! The slots that CasADi's symbols refer to, and who holds them.
//!
//! A slot is held by the Python object that fills it, and by each function of CasADi that was loaded from
//! it: CasADi calls `config` and `incref` when it loads one, `decref` when it deletes one. The last holder
//! empties the slot.

use super::family::Family;
use super::models::Spec;
use std::ffi::{CStr, CString};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Functions that CasADi can refer to at once.
pub const SLOTS: usize = 64;

/// The families, each from when its slot is filled until its last holder lets it go.
static FAMILIES: [AtomicPtr<Family>; SLOTS] = [const { AtomicPtr::new(std::ptr::null_mut()) }; SLOTS];

/// Who holds a slot.
#[derive(Clone, Copy)]
struct Holders {
    count: usize,
    /// Calls of `decref` to come from functions that were refused by `config`.
    refused: usize,
}

static HOLDERS: Mutex<[Holders; SLOTS]> = Mutex::new([Holders { count: 0, refused: 0 }; SLOTS]);

fn holders() -> MutexGuard<'static, [Holders; SLOTS]> {
    HOLDERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The family of a slot.
///
/// # Safety
/// The caller holds the slot as long as it uses the result.
pub unsafe fn family<'a>(slot: usize) -> Option<&'a Family> {
    // SAFETY: a pointer that is not null comes from `Box::into_raw`, and lives until the last holder lets go.
    unsafe { FAMILIES[slot].load(Ordering::Acquire).as_ref() }
}

/// The family of a slot, while no holder can let it go.
fn held(_holders: &MutexGuard<'_, [Holders; SLOTS]>, slot: usize) -> Option<&'static Family> {
    // SAFETY: callers use it only while the guard exists, and a slot is emptied with the guard alone.
    unsafe { family(slot) }
}

/// Fills a slot, or finds the one with the same function, and holds it; `None` if all are in use.
///
/// Where to look first depends on the text alone: a function that another process has stored most likely
/// finds its slot free or its own.
pub fn hold(spec: Spec, text: CString) -> Option<usize> {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    let first = (hasher.finish() % SLOTS as u64) as usize;
    let mut all = holders();
    let order = || (0..SLOTS).map(|k| (first + k) % SLOTS);
    let same = order().find(|&slot| held(&all, slot).is_some_and(|family| family.spec == spec));
    let slot = match same {
        Some(slot) => slot,
        None => {
            let slot = order().find(|&slot| held(&all, slot).is_none())?;
            fill(slot, spec, text);
            slot
        }
    };
    all[slot].count += 1;
    Some(slot)
}

fn fill(slot: usize, spec: Spec, text: CString) {
    let family = Box::into_raw(Box::new(Family::new(spec, text)));
    FAMILIES[slot].store(family, Ordering::Release);
}

/// One more holder.
pub fn add_holder(slot: usize) {
    holders()[slot].count += 1;
}

/// One holder less; the last one empties the slot.
pub fn remove_holder(slot: usize) {
    let mut all = holders();
    all[slot].count = all[slot].count.saturating_sub(1);
    let last = all[slot].count == 0;
    let family =
        if last { FAMILIES[slot].swap(std::ptr::null_mut(), Ordering::AcqRel) } else { std::ptr::null_mut() };
    drop(all);
    if !family.is_null() {
        // SAFETY: it comes from `Box::into_raw`, is taken once, and nobody holds the slot.
        drop(unsafe { Box::from_raw(family) });
    }
}

/// `decref`: as [`remove_holder`], but not for a function that was never a holder.
pub fn decref(slot: usize) {
    let mut all = holders();
    if all[slot].refused > 0 {
        all[slot].refused -= 1;
        return;
    }
    drop(all);
    remove_holder(slot);
}

/// Whether a function may refer to a slot: without a text where the slot is filled; with the text of what it
/// computes where the slot holds that, or is empty and can be filled with it.
///
/// CasADi 3.8 calls `decref` for a function that is refused, without an `incref` before. Older versions do
/// not: the next `decref` is taken for it then, and the slot stays in use. The other mistake would free a
/// function that is evaluated.
pub fn config(slot: usize, text: Option<&CStr>, read: impl FnOnce(&CStr) -> Option<Spec>) -> bool {
    let known = |all: &MutexGuard<'_, _>| {
        held(all, slot).map(|family| family.text.as_c_str() == text.unwrap_or(&family.text))
    };
    let mut accepted = known(&holders()).unwrap_or(false);
    if !accepted && let Some(text) = text {
        let spec = read(text);
        let all = holders();
        accepted = match (held(&all, slot), spec) {
            (Some(family), Some(spec)) => family.spec == spec,
            (None, Some(spec)) => {
                fill(slot, spec, text.to_owned());
                true
            }
            (_, None) => false,
        };
    }
    if !accepted {
        holders()[slot].refused += 1;
    }
    accepted
}

/// How many slots are in use.
pub fn used() -> usize {
    let all = holders();
    (0..SLOTS).filter(|&slot| held(&all, slot).is_some()).count()
}

/// Something of the family of a slot, where it is in use.
pub fn look<R>(slot: usize, what: fn(&Family) -> R) -> Option<R> {
    let all = holders();
    held(&all, slot).map(what)
}
