//! Markdown, and how numbers are written in it.

/// Markdown in the making.
#[derive(Default)]
pub(super) struct Text(pub String);

impl Text {
    pub fn heading(&mut self, title: &str, caption: &str) {
        self.0 += if self.0.is_empty() { "" } else { "\n" };
        self.0 += &format!("## {title}\n");
        self.paragraph(caption);
    }

    pub fn paragraph(&mut self, text: &str) {
        if !text.is_empty() {
            self.0 += &format!("\n{text}\n");
        }
    }

    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        self.0 += "\n";
        self.0 += &line(head.iter().map(|cell| escaped(cell)).collect());
        self.0 += &format!("|{}\n", "---|".repeat(head.len()));
        for row in rows {
            self.0 += &line(row.iter().map(|cell| escaped(cell)).collect());
        }
    }
}

/// A cell's text; names come from files.
pub(crate) fn escaped(cell: &str) -> String {
    let line: String = cell.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.replace('|', "\\|")
}

/// What there is, each once, in the order of first appearance.
pub(super) fn distinct<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut once = Vec::new();
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// Three digits, or all before the point.
pub(crate) fn short(x: f64) -> String {
    let decimals = if x >= 99.95 {
        0
    } else if x >= 9.995 {
        1
    } else {
        2
    };
    format!("{x:.decimals$}")
}

/// 1234567 as 1,234,567.
pub(super) fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
