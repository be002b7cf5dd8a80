//! The data of the page and its script.

use super::data::data;
use crate::motion::Motion;

/// The files of the script, in one scope; each uses those before it.
const SCRIPT: &str = concat!(
    "\n(() => {\n\"use strict\";\n",
    include_str!("js/linear.js"),
    include_str!("js/data.js"),
    include_str!("js/robot.js"),
    include_str!("js/shapes.js"),
    include_str!("js/meshes.js"),
    include_str!("js/shaders.js"),
    include_str!("js/renderer.js"),
    include_str!("js/outline.js"),
    include_str!("js/camera.js"),
    include_str!("js/scene.js"),
    include_str!("js/player.js"),
    include_str!("js/axes.js"),
    include_str!("js/plots.js"),
    include_str!("js/controls.js"),
    include_str!("js/main.js"),
    "})();\n"
);

/// The elements with the data, the solution as it is saved, and the script.
pub fn section(motion: &Motion<'_>) -> String {
    let solution = motion.solution.to_json().unwrap_or_else(|_| "null".into());
    format!(
        "<script type=\"application/json\" id=\"data\">{}</script>\n\
         <script type=\"application/json\" id=\"solution\">{}</script>\n<script>{SCRIPT}</script>\n",
        closed(&data(motion).to_string()),
        closed(&solution)
    )
}

/// JSON in which no name can close the element around it.
fn closed(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::{SCRIPT, closed};

    #[test]
    fn names_do_not_close_the_element_of_the_data() {
        let text = closed(&serde_json::json!(["</script><b>"]).to_string());
        assert!(!text.contains('<'));
        assert_eq!(serde_json::from_str::<[String; 1]>(&text).unwrap(), ["</script><b>"]);
        assert!(!SCRIPT.contains("</script"));
    }
}
