//! The report about an imported mesh.

use super::*;
use crate::words::Language;

#[test]
fn an_imported_mesh_is_reported_until_it_is_dismissed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/meshes/cow.obj");
    let mut session = session();
    session.import(&path);
    assert_eq!(session.world().len(), 3);
    session.notices().pass(Duration::from_secs(60));
    let text = session
        .notices()
        .iter()
        .next()
        .expect("a report")
        .text
        .clone();
    for part in ["cow.obj: 6,000 triangles.", "Size: ", "Closed, volume "] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    assert!(text.lines().count() >= 3, "{text}");
    for line in text.lines() {
        assert!(Language::Chinese.translated(line).is_some(), "{line}");
    }
    session.notices().dismiss("import");
    assert_eq!(session.notices().iter().count(), 0);
}
