#pragma once

namespace armada {

/// Style sheet of the report page: follows the reader's light or dark scheme, wide parts scroll by themselves
/// on a phone.
inline constexpr char kPageStyle[] = R"css(
:root { color-scheme: light dark; --text: #1c2128; --soft: #5b6470; --page: #ffffff; --card: #f5f6f8;
  --line: #d9dde3; --good: #12703f; --bad: #b3261e; --bad-card: #fdecea; }
@media (prefers-color-scheme: dark) {
  :root { --text: #e4e7eb; --soft: #9aa4b0; --page: #15181d; --card: #1d2127; --line: #343a43; --good: #4cc38a;
    --bad: #ff8a80; --bad-card: #3a1d1b; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 74rem; padding: 1.2rem 1rem 3rem; background: var(--page); color: var(--text);
  font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .4rem; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 .6rem; }
.verdict { border-left: .45rem solid var(--good); background: var(--card); border-radius: .3rem; padding: 1rem 1.2rem; }
.verdict.bad { border-color: var(--bad); background: var(--bad-card); }
.verdict b { color: var(--good); } .verdict.bad b { color: var(--bad); }
.verdict p { margin: .3rem 0 0; }
.verdict ul { margin: .5rem 0 0; padding-left: 1.2rem; }
dl { display: grid; grid-template-columns: repeat(auto-fit, minmax(7.5rem, 1fr)); gap: .7rem 1.2rem; margin: 1.2rem 0; }
dl div:first-child { grid-column: span 2; }
dt { color: var(--soft); font-size: .8rem; } dd { margin: 0; font-weight: 600; overflow-wrap: anywhere; }
.wide { overflow-x: auto; border: 1px solid var(--line); border-radius: .3rem; }
table { border-collapse: collapse; font-size: .82rem; font-variant-numeric: tabular-nums; width: 100%; }
th, td { padding: .35rem .45rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
tr:last-child > * { border-bottom: 0; }
thead th { color: var(--soft); font-weight: 600; vertical-align: bottom; background: var(--card); }
tbody th, thead th:first-child { position: sticky; left: 0; text-align: left; background: var(--card); }
td.word, th.word { text-align: left; }
tr.bad > * { background: var(--bad-card); } tr.bad strong { color: var(--bad); }
.swatch { display: inline-block; width: .8em; height: .8em; border-radius: .15em; margin-right: .45em; }
figure { margin: 2rem auto 0; max-width: 60rem; }
figcaption { color: var(--soft); font-size: .9rem; margin-top: .4rem; }
figcaption b { color: var(--text); } figcaption code { font-size: .85em; }
.alarm { color: var(--bad); font-weight: 700; }
.picture svg { display: block; width: 100%; color: var(--text); min-width: 40rem; height: auto; }
.picture svg > g > rect { fill: none; }
.picture svg text { font-family: system-ui, "DejaVu Sans", sans-serif; }
details { margin-top: 2.4rem; } pre { overflow-x: auto; background: var(--card); padding: 1rem; font-size: .8rem; }
@media print { .wide { overflow: visible; } }
)css";

}  // namespace armada
