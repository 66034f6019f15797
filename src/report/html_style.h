// The look of the evaluation report.
#pragma once

namespace livecap {

inline constexpr const char* kHtmlStyle = R"css(
:root{--ink:#1d2430;--soft:#667085;--line:#e3e7ee;--card:#fff;--page:#f4f6f9;--good:#1a7f4b;--bad:#c5283d;--blue:#1f5fbf}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:14px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:1240px;margin:0 auto;padding:28px 24px 60px}
header h1{margin:0;font-size:27px;letter-spacing:-.01em}
header p{margin:4px 0 20px;color:var(--soft)}
section{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:18px 22px 22px;margin:0 0 18px}
h2{margin:0 0 10px;font-size:17px}
.note{margin:-4px 0 12px;color:var(--soft)}
.columns{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:30px}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{text-align:left;font-weight:600;color:var(--soft);font-size:12px;border-bottom:1px solid var(--line);padding:4px 8px}
td{padding:5px 8px;border-bottom:1px solid #f0f2f6;vertical-align:top}
.numbers td:not(:first-child),.numbers th:not(:first-child),.number{text-align:right;white-space:nowrap}
.joints td,.joints th{text-align:center!important;padding:4px 3px}
.facts{margin-top:14px}.facts td:first-child{color:var(--soft);width:45%}
.bars td:last-child,.bars th:last-child{white-space:nowrap;color:var(--soft)}
.indented{padding-left:24px;color:#444f60}
.mark{display:inline-block;min-width:58px;text-align:center;border-radius:9px;padding:1px 8px;font-size:12px;font-weight:600}
.met .mark{background:#e3f4ea;color:var(--good)}.missed .mark{background:#fde7ea;color:var(--bad)}
.unknown .mark{background:#eef0f4;color:var(--soft)}
.missed .number{color:var(--bad);font-weight:600}.met .number{color:var(--good);font-weight:600}
.group td{background:#f7f8fb;font-weight:600;color:var(--soft);font-size:12px}
.full td{background:#eef4fd;font-weight:600}
.worse{color:var(--bad)}.better{color:var(--good)}
.chart{width:100%;height:auto;display:block;margin:0 0 10px;font-family:inherit}
.chart .title{font-size:14px;font-weight:600;fill:var(--ink)}.chart .legend{font-size:12px;fill:var(--soft)}
.chart .tick{font-size:11px;fill:var(--soft)}.chart .grid{stroke:var(--line)}
.chart .bar{stroke:var(--good);stroke-dasharray:6 5}.chart .curve{fill:none;stroke-width:1.8;stroke-linejoin:round;pointer-events:none}
.chart .hover{fill:transparent}.chart .hover:hover{fill:#0000000d}.chart .lost{fill:#c5283d22}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(480px,1fr));gap:22px}
.sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(540px,1fr));gap:18px}.sheet img{width:100%}
figure{margin:0}figure img{max-width:100%;height:auto;display:block;border-radius:6px}
.figures img{margin:0 auto;max-height:430px}
figcaption{margin-top:6px;color:var(--soft);font-size:13px}figcaption b{color:var(--ink)}
.scale{display:flex;align-items:center;gap:8px;margin-top:6px;font-size:12px;color:var(--soft)}
.scale i{display:inline-block;width:220px;height:10px;border-radius:5px;border:1px solid var(--line)}
.red{color:#d62828}.blue{color:#285ac8}
@media(max-width:900px){.columns{grid-template-columns:1fr}}
@media print{body{background:#fff}section{break-inside:avoid}}
)css";

}  // namespace livecap
