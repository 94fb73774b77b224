//! `nephroid study`: its page, its numbers, and how it goes on.

use std::time::Duration;

use roxmltree::{Document, Node, ParsingOptions};
use serde_json::Value;

use crate::support::{Dir, Run};

/// Elements of a page, by name.
fn all<'a>(page: &'a Document<'_>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    page.descendants().filter(move |node| node.has_tag_name(name) || node.has_tag_name((SVG, name)))
}

const SVG: &str = "http://www.w3.org/2000/svg";

fn page(dir: &Dir) -> String {
    String::from_utf8(dir.read("nephroid-study/index.html")).unwrap()
}

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).unwrap()
}

/// Without the lines that tell how long a section took.
fn without_times(page: &str) -> String {
    page.lines().filter(|line| !line.contains("Made in ")).collect()
}

#[test]
fn the_quick_study_has_every_section_and_every_number_in_its_band() {
    let dir = Dir::new();
    let run = dir.run(&["study", "--quick", "--json"]).ends_with(0);
    let told = json(&run);
    assert_eq!(told["all_hold"], true, "{told}");
    assert!(dir.read("nephroid-study/index.html").len() < 20_000_000);
    let sections = told["sections"].as_array().unwrap();
    let known: Vec<_> = nephroid_study::SECTIONS.iter().map(|section| section.id).collect();
    let ids: Vec<_> = sections.iter().map(|section| section["id"].as_str().unwrap()).collect();
    assert_eq!(ids, known);
    for section in sections {
        let numbers = section["numbers"].as_array().unwrap();
        assert!(numbers.iter().any(|number| number["band"].is_array()), "{section}");
    }

    let text = page(&dir);
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let page = Document::parse_with_options(&text, options).unwrap();
    let headings: Vec<_> = all(&page, "h2").map(|h| h.text().unwrap_or_default().to_owned()).collect();
    for section in nephroid_study::SECTIONS {
        let start = format!("{}: ", section.report);
        assert_eq!(headings.iter().filter(|h| h.starts_with(&start)).count(), 1, "{start}{headings:?}");
        let id = |node: Node<'_, '_>| node.attribute("id") == Some(section.id);
        let own = all(&page, "section").find(|node| id(*node)).unwrap();
        assert!(own.descendants().any(|node| node.has_tag_name("p")), "{}", section.id);
    }
    assert_eq!(all(&page, "h1").count(), 1);
    assert!(all(&page, "h3").count() == 0);
    assert!(all(&page, "img").count() > 20);
    for image in all(&page, "img") {
        assert!(image.attribute("alt").is_some_and(|alt| alt.len() > 20), "{:?}", image.attribute("alt"));
        assert!(image.attribute("src").is_some_and(|src| src.starts_with("data:image/png;base64,")));
    }
    for label in page.descendants().filter(|node| node.attribute("role").is_some()) {
        assert!(label.attribute("aria-label").is_some_and(|label| !label.is_empty()));
    }
    // Nothing from elsewhere: each address is of the page itself.
    for address in page.descendants().flat_map(|node| node.attributes()) {
        if ["src", "href", "data", "poster", "action"].contains(&address.name()) {
            let own = address.value().starts_with('#') || address.value().starts_with("data:");
            assert!(own, "{}", address.value());
        }
    }
    for outside in ["url(", "@import", "http:", "https:", "fetch(", "XMLHttpRequest"] {
        let found = text.replace(SVG, "").matches(outside).count();
        assert_eq!(found, 0, "{outside}");
    }
    let mut ids: Vec<_> = page.descendants().filter_map(|node| node.attribute("id")).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id stands twice");
    for link in all(&page, "a").filter_map(|a| a.attribute("href")) {
        assert!(ids.contains(&&link[1..]), "{link}");
    }
}

#[test]
fn pages_of_one_seed_differ_in_their_times_alone() {
    let only = "--only=question-1-3,fig-2-1,fig-2-2";
    let page_of = |threads: &str| {
        let dir = Dir::new();
        dir.run(&["study", "--quick", "--quiet", only, "--threads", threads, "--seed", "5"]).ends_with(0);
        without_times(&page(&dir))
    };
    let one = page_of("1");
    assert!(one == page_of("2"));
    assert!(one.contains("nephroid study --quick --seed 5") && one.contains("--seed 5 --exposure -1.5"));
}

#[test]
fn what_is_finished_is_not_done_again() {
    let dir = Dir::new();
    dir.run(&["study", "--quick", "--quiet", "--only", "fig-2-1"]).ends_with(0);
    assert!(page(&dir).contains("Not in this page") && page(&dir).contains("Fig 2.1: "));
    let kept = dir.read("nephroid-study/sections/fig-2-1.json");
    let run = dir.run(&["study", "--quick", "--only", "question-1-3"]).ends_with(0);
    assert!(run.stderr.contains("Question 1.3") && !run.stderr.contains("Fig 2.1"), "{}", run.stderr);
    assert!(page(&dir).contains("Fig 2.1: ") && page(&dir).contains("Question 1.3: "));
    assert_eq!(dir.read("nephroid-study/sections/fig-2-1.json"), kept);
    // Another seed is another study.
    let run = dir.run(&["study", "--quick", "--only", "fig-2-1", "--seed", "1"]).ends_with(0);
    assert!(run.stderr.contains("Fig 2.1"), "{}", run.stderr);
    assert!(dir.read("nephroid-study/sections/fig-2-1.json") != kept);
}

#[test]
fn a_number_out_of_its_band_is_told_and_ends_with_a_code_of_its_own() {
    let dir = Dir::new();
    dir.run(&["study", "--quick", "--quiet", "--only", "question-1-3"]).ends_with(0);
    // As if the section had found something else.
    let path = dir.path("nephroid-study/sections/question-1-3.json");
    let mut kept: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let parts = kept["body"]["parts"].as_array_mut().unwrap();
    let numbers = parts.iter_mut().find_map(|part| part.get_mut("Numbers")).unwrap();
    numbers[0]["value"] = Value::from(0.5);
    std::fs::write(&path, kept.to_string()).unwrap();
    let run = dir.run(&["study", "--quick", "--json", "--only", "question-1-3"]).ends_with(5);
    assert_eq!(json(&run)["all_hold"], false);
    assert!(
        run.stderr.contains("question-1-3: Least power, three lamps is 0.5 W, not 0.0376987 to 0.0376995"),
        "{}",
        run.stderr
    );
    assert!(page(&dir).contains("Of 7 numbers 1 lie outside of their bands."));
    // Of other sections it says nothing, though the page still has it.
    let run = dir.run(&["study", "--quick", "--json", "--only", "fig-2-1"]).ends_with(0);
    let told = json(&run);
    assert_eq!((told["all_hold"].clone(), told["sections"].as_array().unwrap().len()), (true.into(), 1));
    assert!(page(&dir).contains("1 lie outside of their bands."));
}

#[test]
fn a_section_that_is_not_there_is_an_error_with_its_neighbour() {
    let dir = Dir::new();
    let run = dir.run(&["study", "--only", "fig-2-11x,fig-2-2"]).ends_with(2);
    assert!(run.stderr.contains("the study has no section \"fig-2-11x\"; did you mean"), "{}", run.stderr);
    assert!(dir.files().is_empty());
}

#[cfg(unix)]
#[test]
fn a_study_that_is_stopped_leaves_a_page_and_goes_on() {
    let dir = Dir::new();
    let mut child = dir.command(&["study", "--quiet", "--only", "fig-2-1,fig-2-6"]).spawn().unwrap();
    dir.wait_for("nephroid-study/sections/fig-2-1.json");
    // So that it is in the midst of the next one.
    std::thread::sleep(Duration::from_millis(300));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let page = page(&dir);
    assert!(page.contains("Fig 2.1: ") && !page.contains("Fig 2.6: ") && page.contains("Fig 2.6"));
}
