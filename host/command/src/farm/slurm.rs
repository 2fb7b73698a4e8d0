//! A job as scripts for Slurm. They run in the job's folder, and name the program by the variable `EYERAYS`, if there is one.

use super::{Job, Parts};

const PROGRAM: &str = "exec \"${EYERAYS:-eyerays}\"";

/// Submits both scripts. What is given to it goes on to sbatch: a partition, say, or an account.
const SUBMIT: &str = r#"#!/bin/sh
# Submits the parts of the picture, and their merge for when all of them are done: sh submit.sh [OPTIONS OF SBATCH]
set -eu
cd "$(dirname "$0")"
# Slurm makes no folder for its logs.
mkdir -p parts
array=$(sbatch --parsable "$@" slurm.sh)
# A number, and behind a semicolon the cluster's name where there are several.
merge=$(sbatch --parsable "$@" --dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes merge.sh)
echo "parts ${array%%;*}, merge ${merge%%;*}"
"#;

impl Job {
    /// The script of a part, as a task of an array.
    pub fn array_script(&self) -> String {
        let (name, count) = (&self.name, self.parts.count());
        let head = format!(
            "#!/bin/sh\n#SBATCH --job-name={name}\n#SBATCH --array=0-{}\n#SBATCH --output=parts/part-%a.log\n\
             #SBATCH --open-mode=append\n#SBATCH --requeue\n\
             # Renders a part of the picture. A task that is started again goes on with what its film has.\n\
             set -eu\npart=$SLURM_ARRAY_TASK_ID\n",
            count - 1
        );
        let (range, options) = match self.parts {
            Parts::Samples { samples, .. } => (samples, r#"--samples-from "$from" --samples-to "$to""#.to_owned()),
            Parts::Bands { size: (width, height), .. } => {
                (height, format!(r#"--tile "0,$from,{width},$((to - from))""#))
            }
        };
        let ends = format!("from=$((part * {range} / {count}))\nto=$(((part + 1) * {range} / {count}))\n");
        let words = [std::slice::from_ref(&self.scene), &self.options].concat();
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        let film = r#"--output "parts/part-$part.film" --resume"#;
        format!("{head}{ends}{PROGRAM} render {} \\\n    {options} {film}\n", words.join(" "))
    }

    /// The script that puts the parts together.
    pub fn merge_script(&self) -> String {
        let (name, count, picture) = (&self.name, self.parts.count(), quoted(&self.picture));
        format!(
            "#!/bin/sh\n#SBATCH --job-name={name}-merge\n#SBATCH --output=merge.log\n\
             # Puts the parts of the picture together.\nset -eu\nset --\npart=0\nwhile [ \"$part\" -lt {count} ]; do\n    \
             set -- \"$@\" \"parts/part-$part.film\"\n    part=$((part + 1))\ndone\n\
             {PROGRAM} merge \"$@\" --output {picture}\n"
        )
    }

    /// The script that submits both.
    pub fn submit_script(&self) -> String {
        SUBMIT.to_owned()
    }
}

/// A word of a shell, which it takes as it is.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::farm::example;

    #[test]
    fn an_array_has_a_task_for_each_part() {
        let script = example(Parts::Samples { samples: 10, count: 3 }).array_script();
        for line in [
            "#SBATCH --job-name=my_room\n#SBATCH --array=0-2\n",
            "from=$((part * 10 / 3))\nto=$(((part + 1) * 10 / 3))\n",
            r"render '/scenes/my room.toml' --camera 'a '\''b'\''' \",
            "--samples-from \"$from\" --samples-to \"$to\" --output \"parts/part-$part.film\" --resume\n",
        ] {
            assert!(script.contains(line), "{line}\n{script}");
        }
        let script = example(Parts::Bands { size: (64, 5), count: 2 }).array_script();
        assert!(script.contains("part * 5 / 2") && script.contains("--tile \"0,$from,64,$((to - from))\""), "{script}");
    }

    #[test]
    fn words_are_taken_as_they_are() {
        for (word, want) in [("a.toml", "a.toml"), ("", "''"), ("$HOME", "'$HOME'"), ("a'b", r"'a'\''b'"), ("~", "'~'")]
        {
            assert_eq!(quoted(word), want);
        }
    }
}
