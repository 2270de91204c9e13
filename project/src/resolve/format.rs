//! The format that a file states, and what makes a file unreadable as a whole.

use crate::diagnostic::{self, Diagnostic, DiagnosticKind, Severity};
use crate::file::source::Remark;
use crate::file::{Document, FORMAT, format_is_newer};

/// The use of what came with the present format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum News {
    /// It has quantities, tolerances or parts.
    Used,
    /// It has none.
    Unused,
}

/// Returns the errors for which nothing else of a file is judged: a newer format, and parts that are not in their places.
pub(super) fn check_readable(document: &Document) -> Result<(), Vec<Diagnostic>> {
    if let Some(why) = document.node_at("format").and_then(format_is_newer) {
        return Err(vec![
            document.finding(Severity::Error, Remark::new(DiagnosticKind::Format, "format", why)),
        ]);
    }
    if document.inclusion.is_empty() {
        return Ok(());
    }
    let mut findings = [document.syntax.clone(), document.inclusion.clone()].concat();
    diagnostic::sort(&mut findings);
    Err(findings)
}

/// Returns what is wrong with the format that a file states.
pub(super) fn judge_format(document: &Document, format: u32, news: News) -> Option<Diagnostic> {
    if format == 0 && document.format() == Some(0) {
        let allowed = format!("formats are counted from 1; this version writes format {FORMAT}");
        let remark = Remark::new(DiagnosticKind::Format, "format", allowed).with_value("0");
        return Some(document.finding(Severity::Error, remark));
    }
    let is_older = document.format().is_some_and(|format| format < FORMAT);
    (is_older && news == News::Used).then(|| {
        let allowed = format!(
            "the file has quantities with units, tolerances or parts, which came with format {FORMAT}: an older version of \
             Counterpoise cannot read it"
        );
        let hint = "`counterpoise check --migrate` sets the format".to_owned();
        let remark = Remark::new(DiagnosticKind::Format, "format", allowed).with_value(format.to_string()).hint(Some(hint));
        document.finding(Severity::Warning, remark)
    })
}
