//! The stories of `docs/intention.md` are drawn as this build tells them.

use giveway_lab::stories::StoryKind;
use giveway_people::human::Method;

fn read(path: &str) -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../").to_owned() + path;
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

#[test]
fn the_stories_are_drawn_as_this_build_tells_them() {
    let page = read("docs/intention.md");
    for (tale, method, arguments, file) in [
        (StoryKind::Grid, Method::Chapter3, "grid", "story-grid"),
        (StoryKind::Lab, Method::Chapter3, "lab", "story-lab"),
        (StoryKind::Lab, Method::Detour, "lab --method detour", "story-lab-detour"),
        (StoryKind::Hall, Method::Chapter3, "hall --seed 6", "story-hall"),
        (StoryKind::Hall, Method::Detour, "hall --method detour --seed 6", "story-hall-detour"),
    ] {
        let made = format!("giveway experiment story {arguments} --svg docs/{file}.svg");
        assert!(page.contains(&made), "docs/intention.md does not say {made}");
        assert!(read(&format!("docs/{file}.svg")) == tale.tell(method, 6).chart().to_svg(), "old: {made}");
    }
}
