//! The stage: poses, buttons, keys, pictures.

use super::{Case, assert_silent, browser};
use costate::configuration::FreeKinematics;
use serde_json::Value;

/// How many colours the picture of the stage has, coarsely: a blank one has one or two.
const COLOURS: &str = "new Promise((done) => { costateReport.setTime(0.3); requestAnimationFrame(() => { \
    const source = document.getElementById('canvas'); const copy = document.createElement('canvas'); \
    copy.width = 160; copy.height = 100; const context = copy.getContext('2d'); \
    context.drawImage(source, 0, 0, 160, 100); const pixels = context.getImageData(0, 0, 160, 100).data; \
    const found = new Set(); for (let k = 0; k < pixels.length; k += 4) \
    found.add(pixels[k] >> 4 << 8 | pixels[k + 1] >> 4 << 4 | pixels[k + 2] >> 4); done(found.size); }); })";

#[test]
fn poses_of_the_script_are_those_of_the_library() {
    let case = Case::phases();
    let Some(mut page) = browser("poses") else { return };
    page.show(&case.file, (1000, 800), "light");
    let end = *case.solution.trajectory.t.last().unwrap();
    for k in 0..=20 {
        let time = end * f64::from(k) / 20.0;
        let q = case.solution.trajectory.at(time).unwrap().q;
        let expected = case.problem.robot.poses(&q).unwrap();
        let found = page.value(&format!("costateReport.poses({time:?})"));
        for (joint, pose) in expected.iter().enumerate() {
            let numbers = pose.rotation.iter().chain(pose.translation.iter());
            for (entry, expected) in numbers.enumerate() {
                let found = found[joint][entry].as_f64().unwrap();
                // Positions are written with seven digits, and cubics join 400 of them.
                assert!((found - expected).abs() < 3e-6, "t = {time}, joint {joint}: {found} {expected}");
            }
        }
    }
    assert_silent(&page);
}

/// Of a satellite q is not v integrated: its base has a quaternion.
#[test]
fn poses_of_a_floating_robot_are_those_of_its_kinematics() {
    let case = Case::of("satellite_arm");
    let Some(mut page) = browser("floating") else { return };
    page.show(&case.file, (1000, 800), "light");
    let robot = &case.problem.robot;
    let mut kinematics = FreeKinematics::<f64>::new(robot);
    let end = *case.solution.trajectory.t.last().unwrap();
    let mut moved: f64 = 0.0;
    for k in 0..=20 {
        let time = end * f64::from(k) / 20.0;
        let q = case.solution.trajectory.at(time).unwrap().q;
        kinematics.set_position(&q).unwrap();
        let found = page.value(&format!("costateReport.poses({time:?})"));
        for name in ["base", "shoulder", "elbow"] {
            let joint = robot.joints().iter().position(|joint| joint.name == name).unwrap();
            let frame = robot.frames().iter().position(|frame| frame.name == name).unwrap();
            let pose = kinematics.pose(frame).unwrap();
            let columns = (0..9).map(|entry| pose.rotation[entry % 3][entry / 3]);
            for (entry, expected) in columns.chain(pose.position).enumerate() {
                let found = found[joint][entry].as_f64().unwrap();
                assert!((found - expected).abs() < 3e-6, "t = {time}, {name}, {entry}: {found} {expected}");
            }
            if name == "base" {
                moved = moved.max((1.0 - pose.rotation[0][0]).abs());
            }
        }
    }
    // It turns by 60 degrees about (0.6, 0.8, 0): R_xx = 0.36 + 0.64 cos 60.
    assert!(moved > 0.3, "{moved}");
    assert!(page.value(COLOURS).as_u64().unwrap() > 8, "the stage is blank");
    assert_silent(&page);
}

#[test]
fn the_motion_plays_and_the_keys_move_it() {
    let Some(mut page) = browser("play") else { return };
    page.show(&Case::phases().file, (1000, 800), "light");
    assert_eq!(page.value("costateReport.time()"), 0);
    page.click("#play");
    page.wait("costateReport.isPlaying() && costateReport.time() > 0.05");
    page.click("#play");
    page.wait("!costateReport.isPlaying()");
    page.value("document.activeElement.blur()");
    let time = |page: &mut super::Page| page.value("costateReport.time()").as_f64().unwrap();
    let before = time(&mut page);
    page.key("ArrowRight");
    let end = *Case::phases().solution.trajectory.t.last().unwrap();
    // The end is written with seven digits.
    assert!((time(&mut page) - before - 0.01 * end).abs() < 1e-7);
    page.key("ArrowLeft");
    assert!((time(&mut page) - before).abs() < 1e-9);
    page.key(" ");
    page.wait("costateReport.isPlaying()");
    page.key(" ");
    page.wait("!costateReport.isPlaying()");
    page.key("End");
    assert!((time(&mut page) - end).abs() < 1e-6);
    // Without a loop it stops at the end, with one it goes on from the start.
    page.click("#loop");
    page.click("#back");
    page.click("#play");
    page.wait(&format!("!costateReport.isPlaying() && costateReport.time() > {:?}", 0.999 * end));
    page.click("#loop");
    page.click("#play");
    page.wait("costateReport.isPlaying() && costateReport.time() < 0.5");
    page.key(" ");
    page.value(
        "document.getElementById('slider').value = 500; \
                document.getElementById('slider').dispatchEvent(new Event('input'))",
    );
    assert!((time(&mut page) - 0.5 * end).abs() < 1e-6);
    assert!(page.value("document.getElementById('phase').textContent").as_str().unwrap().contains("of 4"));
    assert_silent(&page);
}

#[test]
fn the_camera_and_all_buttons_of_the_stage_work() {
    let Some(mut page) = browser("stage") else { return };
    page.show(&Case::phases().file, (1200, 900), "light");
    assert!(page.value(COLOURS).as_u64().unwrap() > 12, "the stage is blank");
    let azimuth = "costateReport.view().azimuth";
    let before = page.value(azimuth);
    let [x, y] = page.place("#canvas");
    page.drag([x, y], [x + 90.0, y + 20.0]);
    assert_ne!(page.value(azimuth), before);
    let distance = "costateReport.view().distance";
    let far = page.value(distance).as_f64().unwrap();
    let wheel = serde_json::json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": -120 });
    page.send("Input.dispatchMouseEvent", wheel);
    page.wait(&format!("{distance} < {:?}", 0.95 * far));
    for (preset, elevation) in
        [("front", "0"), ("side", "0"), ("top", "Math.PI / 2"), ("perspective", "0.42")]
    {
        page.click(&format!("[data-preset={preset}]"));
        page.wait(&format!("Math.abs(costateReport.view().elevation - {elevation}) < 1e-3"));
    }
    let layers = page.value("[...document.querySelectorAll('#layers button')].map((b) => b.textContent)");
    for name in ["Path", "Start, end", "Joint axes", "Frames", "Payload", "Grid"] {
        assert!(layers.as_array().unwrap().iter().any(|layer| layer == name), "{name}: {layers}");
    }
    for number in 1..=layers.as_array().unwrap().len() {
        let button = format!("#layers button:nth-child({number})");
        let pressed = format!("document.querySelector('{button}').ariaPressed");
        let before = page.value(&pressed);
        page.click(&button);
        assert_ne!(page.value(&pressed), before);
        assert!(page.value(COLOURS).as_u64().unwrap() > 5);
    }
    for download in ["#csv", "#json"] {
        page.click(download);
    }
    assert_silent(&page);
}

/// Least time and slides: pictures for people to look at, and no complaints, in all widths and colours.
#[test]
fn pages_fit_wide_and_narrow_windows_in_both_schemes() {
    let Some(mut page) = browser("widths") else { return };
    let (wide, narrow) = ((1400, 900), (390, 844));
    for (name, looks) in [
        ("two_link_least_time", [(wide, "dark"), (narrow, "light")]),
        ("cart_pole", [(wide, "light"), (narrow, "dark")]),
    ] {
        let case = Case::of(name);
        for (size, scheme) in looks {
            page.show_sharply(&case.file, size, scheme);
            assert!(page.value(COLOURS).as_u64().unwrap() > 8, "{name}: the stage is blank");
            let width = page.value("document.documentElement.scrollWidth").as_u64().unwrap();
            assert_eq!(width, u64::from(size.0), "{name} {scheme}: wider than the window");
            let outside = page.value(
                "[...document.querySelectorAll('body *')].filter((e) => !e.closest('.wide, pre, svg, .labels') && \
                 e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.tagName + '.' + e.className)",
            );
            assert_eq!(outside, Value::Array(Vec::new()), "{name} {scheme} {size:?}");
            let picture = case.file.with_file_name(format!("{name}_{}_{scheme}.png", size.0));
            std::fs::write(picture, page.picture()).unwrap();
        }
    }
    assert_silent(&page);
}

/// Without WebGL2 the page draws a plainer picture and says so.
#[test]
fn the_page_falls_back_to_two_dimensions() {
    let Some(mut page) = browser("fallback") else { return };
    let without = "HTMLCanvasElement.prototype.getContext = ((own) => function (kind, ...more) { \
        return kind === 'webgl2' ? null : own.call(this, kind, ...more); })(HTMLCanvasElement.prototype.getContext)";
    page.send("Page.addScriptToEvaluateOnNewDocument", serde_json::json!({ "source": without }));
    page.show(&Case::phases().file, (900, 800), "light");
    assert_eq!(page.value("costateReport.renderer"), "2D");
    assert!(page.value("document.getElementById('hint').textContent").as_str().unwrap().contains("WebGL2"));
    assert!(page.value(COLOURS).as_u64().unwrap() > 12, "the stage is blank");
    assert_silent(&page);
}
