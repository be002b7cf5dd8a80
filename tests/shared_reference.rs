//! The independent reference values that lie beside a checkout of the project's design documents, where present.

mod common;

use common::{Reference, check_file};
use std::path::Path;

#[test]
fn shared_references_by_every_route() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let Ok(files) = std::fs::read_dir(shared.join("reference")) else { return };
    let mut count = 0;
    for file in files {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let robot = shared.join("robots").join(format!("{name}.urdf"));
        check_file(&robot, &Reference::read(&path));
        count += 1;
    }
    assert!(count >= 5, "the folder is there but holds {count} files");
}
