// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/report/report_page.hpp"

#include <fmt/format.h>

#include "swarm_monitor/report/svg.hpp"

namespace swarm::monitor {
namespace {

/// Colours are variables, so that the dark theme replaces them in one place; print uses the light
/// ones.
constexpr std::string_view kPageStyle = R"(
:root{--page:#fff;--ink:#1d232b;--soft:#5b6470;--line:#dfe3e8;--card:#f6f7f9;
--good:#12805c;--bad:#c5221f;--s0:#1f77c9;--s1:#d9661f;--s2:#7a5cc0;color-scheme:light}
@media screen and (prefers-color-scheme:dark){:root{--page:#101317;--ink:#e4e8ee;--soft:#9aa5b3;
--line:#2a313b;--card:#181d24;--good:#3ecf9a;--bad:#ff6b64;--s0:#5aa9ee;--s1:#f08c4b;--s2:#b29af0;
color-scheme:dark}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1080px;padding:28px 20px 60px;background:var(--page);color:var(--ink);
font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
header{display:flex;flex-wrap:wrap;align-items:baseline;gap:6px 16px}
h1{font-size:26px;margin:0;letter-spacing:-.01em}
h2{font-size:17px;margin:36px 0 10px}
.soft,caption,figcaption{color:var(--soft)}
.badge{padding:3px 12px;border-radius:99px;color:#fff;font-weight:600;font-size:14px}
.ok{background:#12805c}.failed{background:#c5221f}
.reasons{margin:14px 0 0;padding:10px 14px 10px 32px;border-left:4px solid var(--bad);
background:var(--card);border-radius:0 6px 6px 0}
.figures{display:grid;grid-template-columns:repeat(auto-fill,minmax(158px,1fr));gap:10px;
margin:18px 0 0}
.figure{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 12px}
.figure b{display:block;font-size:21px;font-weight:650;font-variant-numeric:tabular-nums;
line-height:1.25}
.figure span{font-size:13px;color:var(--soft)}
.figure.good b{color:var(--good)}.figure.bad b{color:var(--bad)}
figure{margin:0}
figcaption{font-size:13px;margin-top:4px}
.map,.chart{width:100%;height:auto;display:block}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(400px,1fr));gap:18px}
.chart text{font:11px system-ui,sans-serif;fill:var(--soft)}
.chart .grid{stroke:var(--line)}
.chart .zero{stroke:var(--bad);stroke-dasharray:4 3}
.chart .curve{fill:none;stroke-width:1.6}
.chart .s0{stroke:var(--s0)}.chart .s1{stroke:var(--s1)}.chart .s2{stroke:var(--s2)}
.chart .bar{fill:var(--s0);stroke:none}.chart .bar.s1{fill:var(--s1)}
.chart .mark{stroke:var(--s1);stroke-dasharray:3 3}
.scroll{max-height:460px;overflow:auto;border:1px solid var(--line);border-radius:8px}
table{border-collapse:collapse;width:100%;font-size:13.5px;font-variant-numeric:tabular-nums}
th,td{padding:5px 10px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{position:sticky;top:0;background:var(--card);font-weight:600}
.sortable th{cursor:pointer}
.sortable th[data-order]::after{content:" ▲";font-size:9px}
.sortable th[data-order="-1"]::after{content:" ▼"}
td.text,th.text{text-align:left}
td.wide{white-space:normal;min-width:260px}
.bad-text{color:var(--bad);font-weight:600}
.dot{display:inline-block;width:9px;height:9px;border-radius:9px;margin-right:6px}
@media print{body{max-width:none;padding:0;font-size:11px}.scroll{max-height:none;overflow:visible;
border:0}h2{break-after:avoid}.figure,figure,tr{break-inside:avoid}th{position:static}
.badge,.figure,.dot{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)";

/// Sorts by number where both cells are numbers, else by text; `data-key` replaces the text of a
/// cell.
constexpr std::string_view kScript = R"(
for (const table of document.querySelectorAll('table.sortable')) {
  const heads = [...table.tHead.rows[0].cells];
  const key = (row, i) => row.cells[i].dataset.key ?? row.cells[i].textContent;
  heads.forEach((head, i) => head.addEventListener('click', () => {
    const order = head.dataset.order === '1' ? -1 : 1;
    heads.forEach(other => delete other.dataset.order);
    head.dataset.order = order;
    const rows = [...table.tBodies[0].rows];
    rows.sort((a, b) => {
      const x = key(a, i), y = key(b, i);
      const both = x !== '' && y !== '' && !isNaN(x) && !isNaN(y);
      return order * (both ? x - y : x.localeCompare(y));
    });
    table.tBodies[0].append(...rows);
  }));
}
)";

}  // namespace

std::string report_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}<script>{}</script>\n"
      "</body>\n</html>\n",
      escape_xml(title), kPageStyle, body, kScript);
}

}  // namespace swarm::monitor
