//! One page of HTML with the figures in it: opens from a file, offline.

use crate::svg::escape;

/// A figure on the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// What to call it where it cannot be seen.
    pub title: String,
    /// What it shows and how to read it: plain text.
    pub caption: String,
    /// The figure, as the functions of this crate give it; put in as it is.
    pub svg: String,
}

const STYLE: &str = "\
:root{color-scheme:light dark;--paper:#fff;--ink:#22262b;--soft:#5f6872;--line:#dde1e5}
@media (prefers-color-scheme:dark){:root{--paper:#15181c;--ink:#e4e7ea;--soft:#a0a8b1;--line:#2c3239}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:17px/1.55 Charter,'Bitstream Charter','Iowan Old Style',\
Georgia,serif;font-feature-settings:'kern','liga';hyphens:auto;text-rendering:optimizeLegibility}
main{max-width:1000px;margin:0 auto;padding:3rem 1.25rem 5rem}
h1{font-size:2rem;line-height:1.2;font-weight:600;letter-spacing:-.01em;margin:0 0 1.25rem;text-wrap:balance}
p{max-width:40rem;margin:0 0 .8rem;font-variant-numeric:oldstyle-nums}
figure{margin:3rem 0 0;padding-top:1.5rem;border-top:1px solid var(--line)}
.scroll{overflow-x:auto;margin-inline:-20px}
figure svg{display:block;max-width:100%;height:auto}
figcaption{max-width:40rem;margin-top:.75rem;color:var(--soft);font-size:.9rem;line-height:1.45}
@media (max-width:660px){figure svg{max-width:none}}
@media print{main{max-width:none;padding:0}figure{break-inside:avoid}}";

/// A page with a title, paragraphs of plain text and the figures in their order.
///
/// Nothing is loaded from elsewhere: styles and figures are in the page, and there is no script.
pub fn page(title: &str, summary: &[String], figures: &[Figure]) -> String {
    let title = escape(title);
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}\n</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
    );
    for paragraph in summary {
        html.push_str(&format!("<p>{}</p>\n", escape(paragraph)));
    }
    for Figure {
        title,
        caption,
        svg,
    } in figures
    {
        let (title, caption) = (escape(title), escape(caption));
        html.push_str(&format!(
            "<figure aria-label=\"{title}\">\n<div class=\"scroll\">\n{svg}</div>\n\
             <figcaption>{caption}</figcaption>\n</figure>\n"
        ));
    }
    html.push_str("</main>\n</body>\n</html>\n");
    html
}
