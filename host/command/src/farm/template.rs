//! A job as an Open Job Description template, which OpenJD's own command runs, and AWS Deadline Cloud.

use std::ops::Range;

use super::{Job, Parts};

/// What the template says before its steps. The folder of the films is made by each machine, as a farm that copies files makes none.
const HEAD: &str = r#"specificationVersion: "jobtemplate-2023-09"
name: @NAME@
description: "Renders the parts of a picture with eyerays, and merges them. Written by eyerays farm."
parameterDefinitions:
- name: "Scene"
  type: "PATH"
  objectType: "FILE"
  dataFlow: "IN"
  description: "The scene. The files that it names must lie beside it on every machine."
- name: "Parts"
  type: "PATH"
  objectType: "DIRECTORY"
  dataFlow: "OUT"
  default: "parts"
  description: "The folder of the films."
- name: "Picture"
  type: "PATH"
  objectType: "FILE"
  dataFlow: "OUT"
  default: @PICTURE@
  description: "The picture: .exr, .png or .hdr."
- name: "Eyerays"
  type: "STRING"
  default: "eyerays"
  description: "The program's name or path on the machines."
jobEnvironments:
- name: "Folder"
  script:
    actions:
      onEnter:
        command: "mkdir"
        args: ["-p", "{{Param.Parts}}"]
"#;

/// The seconds that a cancelled task has to write its film.
const NOTICE: u32 = 60;

impl Job {
    /// The template, in YAML.
    pub fn template(&self) -> String {
        let head = HEAD.replace("@NAME@", &quoted(&self.name)).replace("@PICTURE@", &quoted(&self.picture));
        head + "steps:\n" + &self.render_step() + &self.merge_step()
    }

    fn render_step(&self) -> String {
        let last = self.parts.count() - 1;
        let numbers = if last == 0 { "0".to_owned() } else { format!("0-{last}") };
        let (parameters, part) = self.part();
        let space = parameter("Part", "INT", &quoted(&numbers)) + &parameters;
        let film = words(["--output", "{{Param.Parts}}/part-{{Task.Param.Part}}.film", "--resume"]);
        let arguments = [words(["render", "{{Param.Scene}}"]), self.options.clone(), part, film].concat();
        let space = format!("  parameterSpace:\n    taskParameterDefinitions:\n{space}");
        format!("- name: \"Render\"\n{space}{}", script(&arguments))
    }

    /// The parameters that say what of the picture a task renders, beside its number, and the options that take them.
    fn part(&self) -> (String, Vec<String>) {
        match self.parts {
            Parts::Samples { .. } => {
                let from = list(self.parts.ranges().map(|range| range.start.to_string()));
                let to = list(self.parts.ranges().map(|range| range.end.to_string()));
                let parameters = parameter("From", "INT", &from) + &parameter("To", "INT", &to);
                let options = ["--samples-from", "{{Task.Param.From}}", "--samples-to", "{{Task.Param.To}}"];
                (parameters + "    combination: \"(Part, From, To)\"\n", words(options))
            }
            Parts::Bands { size: (width, _), .. } => {
                let tile = |range: Range<u32>| quoted(&format!("0,{},{width},{}", range.start, range.len()));
                let parameters = parameter("Tile", "STRING", &list(self.parts.ranges().map(tile)));
                let options = ["--tile", "{{Task.Param.Tile}}"];
                (parameters + "    combination: \"(Part, Tile)\"\n", words(options))
            }
        }
    }

    fn merge_step(&self) -> String {
        let films = (0..self.parts.count()).map(|part| format!("{{{{Param.Parts}}}}/part-{part}.film"));
        let arguments: Vec<String> =
            words(["merge"]).into_iter().chain(films).chain(words(["--output", "{{Param.Picture}}"])).collect();
        format!("- name: \"Merge\"\n  dependencies:\n  - dependsOn: \"Render\"\n{}", script(&arguments))
    }
}

fn words<const N: usize>(words: [&str; N]) -> Vec<String> {
    words.map(str::to_owned).to_vec()
}

fn parameter(name: &str, kind: &str, range: &str) -> String {
    format!("    - name: \"{name}\"\n      type: \"{kind}\"\n      range: {range}\n")
}

fn list(values: impl Iterator<Item = String>) -> String {
    format!("[{}]", values.collect::<Vec<_>>().join(", "))
}

/// What a task runs. One that is cancelled is told so first, and keeps the samples that it has.
fn script(arguments: &[String]) -> String {
    let arguments: String = arguments.iter().map(|argument| format!("        - {}\n", quoted(argument))).collect();
    format!(
        "  script:\n    actions:\n      onRun:\n        command: \"{{{{Param.Eyerays}}}}\"\n        args:\n{arguments}        \
         cancelation:\n          mode: \"NOTIFY_THEN_TERMINATE\"\n          notifyPeriodInSeconds: {NOTICE}\n"
    )
}

/// A string of JSON, which YAML reads as it is.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::farm::example;

    #[test]
    fn every_part_has_its_samples_and_the_merge_every_film() {
        let template = example(Parts::Samples { samples: 10, count: 3 }).template();
        for line in [
            "name: \"my_room\"",
            "  default: \"my room.exr\"",
            "      range: \"0-2\"",
            "      range: [0, 3, 6]",
            "      range: [3, 6, 10]",
            "    combination: \"(Part, From, To)\"",
            "        - \"--camera\"\n        - \"a 'b'\"",
            "        - \"{{Param.Parts}}/part-{{Task.Param.Part}}.film\"",
            "  - dependsOn: \"Render\"",
            "        - \"{{Param.Parts}}/part-2.film\"\n        - \"--output\"",
        ] {
            assert!(template.contains(&format!("{line}\n")), "{line}\n{template}");
        }
        assert!(!template.contains("part-3.film") && !template.contains('@'), "{template}");
    }

    #[test]
    fn bands_are_tiles_of_the_whole_width() {
        let template = example(Parts::Bands { size: (64, 5), count: 2 }).template();
        assert!(template.contains("      range: [\"0,0,64,2\", \"0,2,64,3\"]\n"), "{template}");
        assert!(template.contains("        - \"--tile\"\n        - \"{{Task.Param.Tile}}\"\n"), "{template}");
        assert!(example(Parts::Samples { samples: 1, count: 1 }).template().contains("range: \"0\"\n"));
    }
}
