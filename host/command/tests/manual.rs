//! What shells and `man` know of the command line.

mod program;

use program::Place;

#[test]
fn shells_are_told_of_every_command_and_option() {
    let place = Place::new(&[]);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = place.succeed(&["completions", shell]);
        for known in ["trace-pixel", "time-limit", "while-while"] {
            assert!(script.text().contains(known), "{shell}: {known}");
        }
    }
    // As bash itself reads it.
    std::fs::write(place.path("eyerays.bash"), place.succeed(&["completions", "bash"]).stdout).unwrap();
    let ask = "source ./eyerays.bash; COMP_WORDS=(eyerays render --deno); COMP_CWORD=2; _eyerays eyerays --deno render; echo ${COMPREPLY[@]}";
    let said = std::process::Command::new("bash").args(["-c", ask]).current_dir(place.path(".")).output();
    if let Ok(said) = said {
        assert_eq!(
            String::from_utf8_lossy(&said.stdout).trim(),
            "--denoise",
            "{}",
            String::from_utf8_lossy(&said.stderr)
        );
    }
}

#[test]
fn there_is_a_page_for_every_command() {
    let place = Place::new(&[("file", "")]);
    let outcome = place.succeed(&["manual", "man/man1"]);
    assert!(outcome.stderr.contains("pages to man/man1"), "{}", outcome.stderr);
    let page = |name: &str| std::fs::read_to_string(place.path("man/man1").join(name)).unwrap();
    let (program, render) = (page("eyerays.1"), page("eyerays-render.1"));
    for command in ["render", "merge", "trace\\-pixel", "manual"] {
        assert!(program.contains(command), "{command}");
    }
    assert!(render.starts_with(".ie") || render.starts_with(".TH"), "{}", &render[..80]);
    assert!(render.contains("time\\-limit") && render.contains("Examples:"));
    place.refuse(&["manual", "file"], &["file", "name a folder"]);
}
