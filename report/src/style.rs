//! The page's style; its colours are the theme's.

/// Style of the page around the figures.
pub const PAGE_CSS: &str = "\
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 system-ui,'Segoe UI','DejaVu Sans',sans-serif}
main{max-width:1360px;margin:0 auto;padding:20px 28px 40px}
header h1{margin:0;font-size:25px}header p{margin:0 0 12px}
h2{font-size:20px;margin:34px 0 8px;border-bottom:1px solid var(--grid);padding-bottom:4px}
h3{font-size:14px;margin:0 0 6px;font-weight:600}
p{max-width:85ch;overflow-wrap:anywhere}
.soft{color:var(--soft);font-size:13px}
.headline{display:flex;gap:14px;align-items:center;padding:12px 18px;border-radius:8px;border:1px solid var(--grid);border-left-width:8px;background:var(--panel);margin-bottom:14px}
.headline strong{font-size:19px}.headline .sign{font-size:28px;line-height:1}
.headline.good{border-left-color:var(--good)}.headline.good .sign{color:var(--good)}
.headline.bad{border-left-color:var(--bad)}.headline.bad .sign{color:var(--bad)}
.headline.none{border-left-color:var(--none)}.headline.none .sign{color:var(--none)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(140px,1fr));gap:10px;margin-bottom:14px}
.tile{display:flex;flex-direction:column;padding:8px 12px;border:1px solid var(--grid);border-top-width:3px;border-radius:8px;background:var(--panel)}
.tile.good{border-top-color:var(--good)}.tile.bad{border-top-color:var(--bad)}
.tile .label{font-size:12.5px;color:var(--soft)}.tile .value{font-size:22px;font-weight:600}.tile small{font-size:13px;font-weight:400}
.tile .soft{font-size:12px}
.pair{display:grid;grid-template-columns:minmax(0,1.05fr) minmax(0,1fr);gap:18px}
@media (max-width:1200px){.pair{grid-template-columns:minmax(0,1fr)}}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(560px,100%),1fr));gap:18px;align-items:start}
figure{margin:0 0 4px;padding:12px 12px 8px;border:1px solid var(--grid);border-radius:8px;background:var(--panel);max-width:860px}
figure svg{width:100%;height:auto;display:block}
figcaption{font-size:13px;color:var(--soft);margin-top:6px}
code{font:12px ui-monospace,'DejaVu Sans Mono',monospace;background:var(--grid);padding:1px 5px;border-radius:4px}
.table{overflow-x:auto;margin:8px 0 14px}
table{border-collapse:collapse;width:100%;font-size:13.5px;background:var(--panel)}
caption{text-align:left;font-weight:600;padding:4px 0}
th{font-weight:600;color:var(--soft);border-bottom:1.5px solid var(--frame)}
.pair-of{white-space:nowrap}
td.words:first-child{min-width:2.5em}.pair td.words:first-child{min-width:12em}
th,td{padding:3.5px 10px 3.5px 0;text-align:left;vertical-align:baseline}td{border-bottom:1px solid var(--grid)}
.number{text-align:right;white-space:nowrap;padding-left:8px;font-variant-numeric:tabular-nums}
th.number{white-space:normal}
.chip{font-weight:600;white-space:nowrap}.chip.good{color:var(--good)}.chip.bad{color:var(--bad)}.chip.none{color:var(--none);white-space:normal}
.room{display:inline-block;width:54px;height:8px;border-radius:4px;background:var(--grid);margin-right:8px;overflow:hidden}
.room i{display:block;height:100%}.room.good i{background:var(--good)}.room.bad i{background:var(--bad)}
nav{display:flex;flex-wrap:wrap;gap:6px 18px;margin-top:18px;padding:8px 0;border-top:1px solid var(--grid);border-bottom:1px solid var(--grid)}
nav a{color:var(--c1);text-decoration:none}nav a:hover{text-decoration:underline}
footer{margin-top:34px;color:var(--soft);font-size:13px}dl{display:grid;grid-template-columns:max-content 1fr;gap:2px 16px;margin:0}dd{margin:0;overflow-wrap:anywhere}
@page{size:A4;margin:12mm}
@media print{
main{max-width:none;padding:0}nav{display:none}body{font-size:12.5px}table{font-size:11px}h2{margin:22px 0 6px}h3{font-size:12.5px}figcaption{font-size:11px}code{font-size:10.5px}figure{padding:8px 8px 4px}.figures,.pair{gap:10px}.tiles{grid-template-columns:repeat(auto-fit,minmax(98px,1fr));gap:6px}.tile{padding:5px 8px}.tile .value{font-size:17px}figure,tr,.tile,.headline{break-inside:avoid}h2,section>p{break-after:avoid}section>p{break-inside:avoid}.figures{grid-template-columns:1fr 1fr}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
";
