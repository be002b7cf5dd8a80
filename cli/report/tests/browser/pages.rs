//! What a page hands on and how it looks: pan, full screen, speeds, files, shades, models, obstacles.

use super::{Case, assert_silent, browser};
use costate_control::Solution;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[test]
fn shift_and_drag_pans_and_the_view_fills_the_screen() {
    let Some(mut page) = browser("pan") else { return };
    page.show(&Case::phases().file, (1200, 900), "light");
    let view =
        "[costateReport.view().azimuth, costateReport.view().elevation, ...costateReport.view().target]";
    let before = page.value(view);
    let [x, y] = page.place("#canvas");
    page.drag_with([x, y], [x + 80.0, y - 40.0], SHIFT);
    let after = page.value(view);
    assert_eq!([&before[0], &before[1]], [&after[0], &after[1]], "it turned");
    assert_ne!(before, after, "it did not move");
    page.click("[data-preset=front]");
    page.wait("Math.abs(costateReport.view().elevation) < 1e-3");

    page.click("#full");
    page.wait("document.fullscreenElement !== null && document.fullscreenElement.id === 'view'");
    // The stage is as large as the window.
    page.wait("Math.abs(document.getElementById('canvas').getBoundingClientRect().width - innerWidth) < 2");
    page.click("#full");
    page.wait("document.fullscreenElement === null");
    assert_silent(&page);
}

/// The bit of the Shift key in events of the DevTools protocol.
const SHIFT: u32 = 8;

#[test]
fn the_menu_of_speeds_is_kept() {
    let Some(mut page) = browser("speeds") else { return };
    page.show(&Case::phases().file, (1000, 800), "light");
    for speed in [0.1, 0.5] {
        page.value(&format!("costateReport.setTime(0); document.getElementById('speed').value = '{speed}'"));
        page.click("#play");
        page.wait("costateReport.time() > 0");
        // By the stamps of frames, which the page goes by as well: however late one is, both see the same.
        let rate = page.value(
            "new Promise((done) => { let first = null; const look = (now) => { \
             first = first || [costateReport.time(), now]; \
             return now - first[1] > 100 \
             ? done(1000 * (costateReport.time() - first[0]) / (now - first[1])) : requestAnimationFrame(look); }; \
             requestAnimationFrame(look); })",
        );
        page.click("#play");
        let rate = rate.as_f64().unwrap();
        assert!((rate / speed - 1.0).abs() < 1e-6, "{speed}: {rate}");
    }
    assert_silent(&page);
}

#[test]
fn downloads_are_the_table_and_the_solution() {
    let case = Case::phases();
    let Some(mut page) = browser("downloads") else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("downloads");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    page.send("Browser.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": folder }));
    page.show(&case.file, (1000, 800), "light");
    page.click("#csv");
    let csv = std::fs::read_to_string(downloaded(&folder, "csv")).unwrap();
    assert_eq!(page.value("costateReport.table()"), csv);
    page.click("#json");
    let json = std::fs::read_to_string(downloaded(&folder, "json")).unwrap();
    let read: Solution = serde_json::from_str(&json).unwrap();
    assert_eq!(read.trajectory.t, case.solution.trajectory.t);
    assert_eq!(read.trajectory.q, case.solution.trajectory.q);
    assert_silent(&page);
}

/// The file of this kind, once the browser has finished it.
fn downloaded(folder: &Path, extension: &str) -> PathBuf {
    let begun = Instant::now();
    loop {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        if let Some(path) =
            files.into_iter().find(|path| path.extension().is_some_and(|end| end == extension))
        {
            return path;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no file .{extension}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A motion that was not asked to keep the limits of its robot is shaded where it is beyond them.
#[test]
fn what_is_beyond_a_limit_is_shaded() {
    let Some(mut page) = browser("shades") else { return };
    page.show(&Case::hasty().file, (1000, 800), "light");
    let shades = "document.querySelectorAll('[data-plot=rates] .beyond').length";
    let all = page.value(shades).as_u64().unwrap();
    assert!(all > 0);
    // They belong to their curves: the first joint turns too fast.
    page.click("#joints .chip");
    let without = page.value(shades).as_u64().unwrap();
    assert!(without < all, "{without} of {all} shades are left");
    // This one keeps its limits.
    page.show(&Case::phases().file, (1000, 800), "light");
    assert_eq!(page.value("document.querySelectorAll('[data-plot=rates] .beyond').length"), 0);
    assert_silent(&page);
}

/// A UR5 with its visual models, and one that goes round an obstacle: pictures for people to look at.
#[test]
fn visual_models_and_obstacles_are_shown_in_narrow_dark_windows() {
    let Some(mut page) = browser("models") else { return };
    for (name, case) in [("ur5", Case::phases()), ("obstacle", Case::around())] {
        assert!(!case.models.is_empty());
        for (size, scheme) in [((390, 844), "dark"), ((1400, 900), "light")] {
            page.show_sharply(&case.file, size, scheme);
            page.value("costateReport.setTime(0.4)");
            let width = page.value("document.documentElement.scrollWidth").as_u64().unwrap();
            assert_eq!(width, u64::from(size.0), "{name} {scheme}: wider than the window");
            let picture = case.file.with_file_name(format!("{name}_{}_{scheme}.png", size.0));
            std::fs::write(picture, page.picture()).unwrap();
        }
    }
    let layers = page.value("[...document.querySelectorAll('#layers button')].map((b) => b.textContent)");
    assert!(layers.as_array().unwrap().iter().any(|layer| layer == "Obstacles"), "{layers}");
    assert_silent(&page);
}
