//! The plots: values, legends, zoom, units, the table.

use super::{Case, assert_silent, browser};

/// The values beside the names in the legend of a plot.
fn values(page: &mut super::Page, plot: &str) -> Vec<f64> {
    let list = page.value(&format!(
        "[...document.querySelectorAll('[data-plot={plot}] .chip b')].map((b) => b.textContent.replace('\u{2212}', '-'))"
    ));
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().parse().unwrap()).collect()
}

#[test]
fn plots_show_values_limits_and_follow_the_pointer() {
    let case = Case::phases();
    let Some(mut page) = browser("plots") else { return };
    page.show(&case.file, (1300, 900), "light");
    for id in [
        "positions",
        "rates",
        "accelerations",
        "jerks",
        "controls",
        "torque_rates",
        "powers",
        "total_power",
        "energy",
        "tool_speed",
        "costates_q",
        "hamiltonian",
        "mesh",
        "residuals",
    ] {
        let curves = format!("document.querySelectorAll('[data-plot={id}] .curve').length");
        assert!(page.value(&curves).as_u64().unwrap() > 0, "{id}");
    }
    // A click moves the robot there, and the legend shows the values of that time.
    let end = *case.solution.trajectory.t.last().unwrap();
    page.place("[data-plot=rates] svg");
    let place = page.value(
        "(() => { const r = document.querySelector('[data-plot=rates] svg').getBoundingClientRect(); \
         return [r.left, r.width, r.top + 90]; })()",
    );
    let [left, width, y] = [0, 1, 2].map(|k| place[k].as_f64().unwrap());
    let at = |part: f64| [left + 54.0 + part * (width - 66.0), y];
    page.click_at(at(0.37), 1);
    let time = page.value("costateReport.time()").as_f64().unwrap();
    assert!((time - 0.37 * end).abs() < 0.01 * end, "{time}");
    page.mouse("mouseMoved", [2.0, 2.0], 0);
    let expected = case.solution.trajectory.at(time).unwrap().v;
    for (found, expected) in values(&mut page, "rates").into_iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-3 * (1.0 + expected.abs()), "{found} {expected}");
    }
    let samples = case.solution.sample_at(&case.problem, &[time]).unwrap();
    for (found, expected) in values(&mut page, "powers").into_iter().zip(0..6) {
        let expected = samples.tau[0][expected] * samples.v[0][expected];
        assert!((found - expected).abs() < 2e-2 * (1.0 + expected.abs()), "{found} {expected}");
    }
    let unit = "document.querySelector('[data-plot=rates] .unit').textContent";
    assert_eq!(page.value(unit), "v in rad/s");
    page.click("#units");
    assert_eq!(page.value(unit), "v in deg/s");
    for (found, expected) in values(&mut page, "rates").into_iter().zip(&expected) {
        assert!((found - expected.to_degrees()).abs() < 0.1 * (1.0 + expected.abs()), "{found} {expected}");
    }
    page.click("#units");
    // Limits of torques belong to their curves, and vanish with them.
    let limits = "document.querySelectorAll('[data-plot=controls] .curve').length";
    page.click("[data-plot=controls] .chip");
    assert_eq!(page.value(limits), 5);
    page.click("#joints .chip");
    assert_eq!(page.value(limits), 6);
    // Dragging zooms all plots, a double click shows the whole motion again.
    page.place("[data-plot=rates] svg");
    let top = page.value("document.querySelector('[data-plot=rates] svg').getBoundingClientRect().top + 90");
    let at = |part: f64| [at(part)[0], top.as_f64().unwrap()];
    page.drag(at(0.2), at(0.6));
    assert_eq!(page.value("document.getElementById('whole').hidden"), false);
    page.click_at(at(0.5), 1);
    let time = page.value("costateReport.time()").as_f64().unwrap();
    assert!((time - 0.4 * end).abs() < 0.02 * end, "{time}");
    page.click_at(at(0.5), 2);
    assert_eq!(page.value("document.getElementById('whole').hidden"), true);
    assert_silent(&page);
}

/// The joints whose limits are drawn are named within the plot, and no name lies on another one.
#[test]
fn limits_have_names_that_can_be_read() {
    let puma = Case::of("puma560_pick_and_place");
    let Some(mut page) = browser("names") else { return };
    for (case, least) in [(&puma, 6), (Case::phases(), 2)] {
        for width in [1400, 390] {
            page.show(&case.file, (width, 900), "dark");
            let names = page.value(
                "[...document.querySelectorAll('[data-plot=controls] .whose')].map((text) => { \
                 const edge = text.ownerSVGElement.querySelector('clipPath rect').getBBox(), b = text.getBBox(); \
                 return [b.x >= edge.x && b.y >= edge.y - 1 && b.y + b.height <= edge.y + edge.height + 1, \
                 b.x, b.x + b.width, b.y, b.y + b.height]; })",
            );
            let names = names.as_array().unwrap();
            assert!(names.len() >= least, "{names:?}");
            let number = |name: &serde_json::Value, k: usize| name[k].as_f64().unwrap();
            for (k, name) in names.iter().enumerate() {
                assert_eq!(name[0], true, "{names:?}");
                // Lines are a little higher than the letters on them.
                let lies_on = |other: &serde_json::Value| {
                    number(name, 1) < number(other, 2)
                        && number(other, 1) < number(name, 2)
                        && number(name, 3) + 2.0 < number(other, 4)
                        && number(other, 3) + 2.0 < number(name, 4)
                };
                assert!(!names[..k].iter().any(lies_on), "{names:?}");
            }
        }
    }
    assert_silent(&page);
}

/// The table has the columns of `--sample-to`, and more; its rows are the motion.
#[test]
fn the_table_holds_the_motion() {
    let case = Case::phases();
    let Some(mut page) = browser("table") else { return };
    page.show(&case.file, (800, 800), "light");
    let table = page.value("costateReport.table()");
    let lines: Vec<&str> = table.as_str().unwrap().lines().collect();
    let names: Vec<&str> = lines[0].split(',').collect();
    let column = |name: &str| names.iter().position(|other| *other == name).unwrap();
    let expected = [
        "t",
        "q_elbow_joint",
        "v_elbow_joint",
        "a_elbow_joint",
        "tau_elbow_joint",
        "u_elbow_joint",
        "power_elbow_joint",
        "jerk_elbow_joint",
        "torque_rate_elbow_joint",
        "phase",
    ];
    let columns = expected.map(column);
    for line in lines[1..].iter().step_by(37) {
        let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let numbers = columns.map(|column| row[column]);
        let samples = case.solution.sample_at(&case.problem, &numbers[..1]).unwrap();
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-3 * (1.0 + expected.abs());
        assert!(near(numbers[1], samples.q[0][2]) && near(numbers[2], samples.v[0][2]), "{line}");
        // Beside a jump the rounded time may lie on its other side.
        let is_smooth = case.solution.trajectory.t.iter().all(|t| (t - numbers[0]).abs() > 1e-5);
        assert!(!is_smooth || near(numbers[4], samples.tau[0][2]), "{line}");
        assert!(near(numbers[6], numbers[4] * numbers[2]), "{line}");
    }
    assert_silent(&page);
}
