var Xv=[Float32Array,Int16Array,Uint16Array,Uint8Array,Int32Array,Uint32Array,Float64Array],$p=32,Xp=16;function qp(i,t){let e="";for(let n=0;n<8;n++){let s=i.getUint8(t+n);s&&(e+=String.fromCharCode(s))}return e}function Fs(i){let t=new DataView(i);if(t.getUint32(0)!==1128416817)throw new Error("not a state frame");let e=t.getUint32(20,!0),n={channel:qp(t,8),sequence:t.getUint32(16,!0),time:t.getFloat64(24,!0),arrays:{},columns:{}},s=$p+Xp*e;for(let r=0;r<e;r++){let o=$p+Xp*r,a=Xv[t.getUint16(o+8,!0)],l=t.getUint32(o+12,!0);s+=(8-s%8)%8;let c=qp(t,o);n.arrays[c]=new a(i,s,l),n.columns[c]=t.getUint16(o+10,!0),s+=l*a.BYTES_PER_ELEMENT}return n}var Yp=[250,500,1e3,2e3],_l=class extends EventTarget{constructor(t,e="socket"){super(),this._name=e,this.session=t,this.open=!1,this._calls=new Map,this._frames=new Map,this._number=0,this._failures=0,this._connect()}call(t,e={}){return new Promise((n,s)=>{if(!this.open)return s(new Error("the server is not connected"));let r=++this._number;this._calls.set(r,{resolve:n,reject:s}),this._socket.send(JSON.stringify({id:r,call:t,args:e}))})}on(t,e){let n=s=>e(s.detail);return this.addEventListener(t,n),()=>this.removeEventListener(t,n)}draw(t,e){this._frames.set(t,e)}address(t,e,n={}){let s=new URLSearchParams(n).toString();return`api/${this.session}/${t}/${e}${s?`?${s}`:""}`}_connect(){let t=new URL(`api/${this.session}/${this._name}`,location.href);t.protocol=t.protocol.replace("http","ws");let e=new WebSocket(t);e.binaryType="arraybuffer",e.onopen=()=>{this.open=!0,this._failures=0,this._emit("connected")},e.onmessage=n=>this._receive(n.data),e.onclose=()=>this._lost(),this._socket=e}async _receive(t){if(typeof t!="string"){let s=Fs(t);try{await this._frames.get(s.channel)?.(s)}finally{this._socket.readyState===WebSocket.OPEN&&this._socket.send(JSON.stringify({drawn:s.sequence}))}return}let e=JSON.parse(t);if(e.event)return this._emit(e.event,e.data);let n=this._calls.get(e.id);this._calls.delete(e.id),"error"in e?n?.reject(new Error(e.error)):n?.resolve(e.result)}_lost(){this.open=!1;for(let{reject:e}of this._calls.values())e(new Error("the connection to the server was lost"));this._calls.clear(),this._emit("lost");let t=Yp[Math.min(this._failures++,Yp.length-1)];setTimeout(()=>this._connect(),t)}_emit(t,e){this.dispatchEvent(new CustomEvent(t,{detail:e}))}};var Zp=i=>i!=null&&i!==!1;function f(i,t={},...e){let n=document.createElement(i);for(let[s,r]of Object.entries(t))s.startsWith("on")?n.addEventListener(s.slice(2),r):r===!0?n.setAttribute(s,""):r!==!1&&r!==null&&r!==void 0&&n.setAttribute(s,r);return n.append(...e.flat().filter(Zp)),n}function pt(i,...t){return i.replaceChildren(...t.flat().filter(Zp)),i}function en(i,t,e=null){return f("label",{class:"field"},f("span",{},i),t,e&&f("small",{},e))}function we(i,t,e=[["Close",()=>!0]]){let n=f("dialog",{"aria-label":i}),s=async r=>{await r()!==!1&&n.close()};return n.append(f("h2",{},i),f("div",{class:"dialog-body"},t),f("div",{class:"dialog-buttons"},e.map(([r,o],a)=>f("button",{type:"button",class:a===e.length-1?"main":"",onclick:()=>s(o)},r)))),n.addEventListener("close",()=>n.remove()),document.body.append(n),n.showModal(),n}var yl=f("div",{class:"messages",role:"status","aria-live":"polite"}),Kp=yl;function me(i,t="note"){let e=f("div",{class:`message ${t}`},f("span",{},i));for(e.append(f("button",{type:"button","aria-label":"Close message",onclick:()=>e.remove()},"\xD7")),yl.append(e);yl.children.length>4;)yl.firstChild.remove();t!=="error"&&setTimeout(()=>e.remove(),6e3)}async function he(i){try{return await i()}catch(t){me(t.message,"error");return}}var vl=class{constructor(){this._sets=new Map,this.active=null,document.addEventListener("keydown",t=>this._press(t))}add(t,e){this._sets.set(t,[...this._sets.get(t)??[],...e])}list(){return[...this._sets.get(this.active)??[],...this._sets.get(null)??[]]}_press(t){if(t.ctrlKey||t.metaKey||t.altKey)return;let e=t.target;if(e.closest("input, textarea, select, dialog, [contenteditable]")||(t.key===" "||t.key==="Enter")&&e.closest("button, summary, a")||t.key.startsWith("Arrow")&&e.closest("[role=tab], [role=slider], [role=listbox]"))return;let n=this.list().find(([s])=>s===t.key);n&&(t.preventDefault(),n[2](t))}};function Jp(i){return{" ":"Space",ArrowRight:"\u2192",ArrowLeft:"\u2190",ArrowUp:"\u2191",ArrowDown:"\u2193"}[i]??i}var xl=class{constructor(t,e){this.tabs=e,this.keys=new vl,this.address=new URLSearchParams(location.hash.slice(1)),this.connection=new _l(this.address.get("session")??"main"),this._views=new Map,this._layout(t),this._listen(),this.select(this.address.get("tab")??e[0].name)}tab(t){return this._views.get(t)}select(t){let e=this.tabs.find(n=>n.name===t)??this.tabs[0];for(let n of this.tabs){let s=n===e,r=this._buttons.get(n.name);r.setAttribute("aria-selected",String(s)),r.tabIndex=s?0:-1,this._panels.get(n.name).hidden=!s,s||this._views.get(n.name)?.hide?.()}this._views.has(e.name)||(this._views.set(e.name,e.mount(this._panels.get(e.name),this)),this._greeting&&this._views.get(e.name).greet?.(this._greeting.desks[e.name]??{})),this.keys.active=e.name,this.remember({tab:e.name}),this._views.get(e.name).show?.()}remember(t){for(let[e,n]of Object.entries(t))n==null?this.address.delete(e):this.address.set(e,String(n));history.replaceState(null,"",`#${this.address}`)}get theme(){return document.documentElement.dataset.theme}_layout(t){this._buttons=new Map,this._panels=new Map;for(let{name:r,title:o}of this.tabs)this._buttons.set(r,f("button",{role:"tab",id:`tab-${r}`,"aria-controls":`panel-${r}`,onclick:()=>this.select(r)},o)),this._panels.set(r,f("section",{role:"tabpanel",id:`panel-${r}`,"aria-labelledby":`tab-${r}`,hidden:!0}));this._status=f("span",{class:"connection",role:"status"},"connecting");let e=f("nav",{role:"tablist","aria-label":"Tabs"},[...this._buttons.values()]);e.addEventListener("keydown",r=>this._moveTab(r)),pt(t,f("header",{},f("h1",{},"crowdbot"),e,this._status,f("button",{type:"button",onclick:()=>this._toggleTheme()},"Theme"),f("button",{type:"button","aria-label":"Keys",onclick:()=>this._showKeys()},"?")),f("main",{},[...this._panels.values()]),Kp);let n=this.address.get("theme")??localStorage.getItem("theme"),s=matchMedia("(prefers-color-scheme: dark)").matches?"dark":"light";document.documentElement.dataset.theme=n??s,this.keys.add(null,[["?","Show the keys",()=>this._showKeys()]])}_listen(){this.connection.on("connected",()=>this._tellConnection("connected","")),this.connection.on("lost",()=>this._tellConnection("not connected, trying again","lost")),this.connection.on("hello",t=>{this._greeting=t,t.desks.jobs&&this._countJobs(t.desks.jobs);for(let[e,n]of this._views)n.greet?.(t.desks[e]??{})}),this.connection.on("jobs.state",t=>this._countJobs(t))}_countJobs({jobs:t}){let e=t.filter(s=>s.state==="running"||s.state==="waiting").length,{title:n}=this.tabs.find(s=>s.name==="jobs");this._buttons.get("jobs").textContent=e?`${n} (${e})`:n}_tellConnection(t,e){this._status.textContent=t,this._status.className=`connection ${e}`}_moveTab(t){let e={ArrowRight:1,ArrowLeft:-1}[t.key];if(!e)return;let n=this.tabs.map(r=>r.name),s=n[(n.indexOf(this.keys.active)+e+n.length)%n.length];this.select(s),this._buttons.get(s).focus()}_toggleTheme(){let t=this.theme==="dark"?"light":"dark";document.documentElement.dataset.theme=t,localStorage.setItem("theme",t),document.dispatchEvent(new CustomEvent("theme",{detail:t}))}_showKeys(){let t=this.keys.list().map(([e,n])=>f("tr",{},f("td",{},f("kbd",{},Jp(e))),f("td",{},n)));we("Keys",f("table",{},f("tbody",{},t)))}};var nn=(i,t=0)=>{let e=Number.parseFloat(i);return Number.isFinite(e)?e:t};function Os(i){return(i??"").trim().replace(/\s*,\s*/g,",").split(/\s+/).map(t=>t.split(",").map(Number)).filter(t=>t.length===2&&t.every(Number.isFinite))}var ze=i=>String(Math.round(i*1e3)/1e3),si=i=>i.map(([t,e])=>`${ze(t)},${ze(e)}`).join(" "),jp={wall:[["points",!1,"wall"]],obstacle:[["points",!0,"solid"]],stage:[["walkable",!0,"ground"]],door:[["points",!1,"door"]],spawner:[["zone",!0,"people"],["goal",!0,"goal"]],source:[["zone",!0,"people"],["goal",!0,"goal"]],exit:[["zone",!0,"exit"]],portal:[["zone",!0,"exit"]],zone:[["points",!0,"goal"]],agent:[["goal-zone",!0,"goal"],["goal",!1,"target"]]},Bu={cube:i=>[nn(i.size,.5),nn(i.size,.5)],table:i=>[nn(i.length,1.6),nn(i.width,.8)],ramp:i=>[nn(i.length,1),nn(i.width,1.5)],platform:i=>[nn(i.length,1),nn(i.width,1)],threshold:i=>[nn(i.depth,.1),nn(i.width,1)],stairs:i=>[nn(i.steps,1)*nn(i.tread,.29),nn(i.width,1.5)]},Qp={tree:i=>[nn(i.trunk,.15),"solid"],light:()=>[.15,"light"],agent:i=>[nn(i.radius,.25),"person"],avatar:i=>[nn(i.radius,.25),"person"],robot:i=>[nn(i.radius,.3),"robot"],goal:i=>[nn(i.tolerance,.3),"target"],point:i=>[nn(i.tolerance,.3),"target"],camera:()=>[.2,"camera"]},qv=new Set(["robot","agent","camera","avatar","ramp","stairs","cube","table"]);function zu(i,t=[]){let e=[],n=i.tag==="camera"&&i.attributes.robot;for(let[r,o,a]of jp[i.tag]??[]){let l=Os(i.attributes[r]);l.length&&e.push({path:t,tag:i.tag,style:a,points:l,closed:o,attribute:r})}Bu[i.tag]?e.push(Zv(i,t)):Qp[i.tag]&&"x"in i.attributes&&!n&&e.push(Yv(i,t));let s=i.children.flatMap((r,o)=>zu(r,[...t,o]));return[...e,...s]}function Yv(i,t){let[e,n]=Qp[i.tag](i.attributes),s=qv.has(i.tag)&&"heading"in i.attributes?nn(i.attributes.heading):null;return{path:t,tag:i.tag,style:n,centre:bl(i),radius:e,heading:s,points:[bl(i)],closed:!1}}function Zv(i,t){let[e,n]=Bu[i.tag](i.attributes),s=nn(i.attributes.heading),[r,o]=bl(i),[a,l]=[Math.cos(s),Math.sin(s)],c=[[1,1],[-1,1],[-1,-1],[1,-1]].map(([h,d])=>[r+(a*h*e-l*d*n)/2,o+(l*h*e+a*d*n)/2]);return{path:t,tag:i.tag,style:"prop",points:c,closed:!0,centre:[r,o],heading:s}}var bl=i=>[nn(i.attributes.x),nn(i.attributes.y)];function Hu(i,t,e,n){let s=[];if("x"in i.attributes||Bu[i.tag]||i.tag==="robot"||i.tag==="agent"){let[o,a]=bl(i);return s.push({path:t,name:"x",value:ze(o+e)},{path:t,name:"y",value:ze(a+n)}),s}let[[r]=[]]=jp[i.tag]??[];if(r){let o=Os(i.attributes[r]).map(([a,l])=>[a+e,l+n]);s.push({path:t,name:r,value:si(o)})}return s}function tm(i,t,e,n,s){let r=Os(i.attributes[e]).map(([o,a])=>[o+n,a+s]);return[{path:t,name:e,value:si(r)}]}function em(i,t,e,n,s){let r=Os(i.attributes[e]);return r[n]=s,[{path:t,name:e,value:si(r)}]}function nm(i,t=[]){let e=[...i.flatMap(r=>r.points),...t];if(!e.length)return[-5,-5,5,5];let n=e.map(r=>r[0]),s=e.map(r=>r[1]);return[Math.min(...n)-1,Math.min(...s)-1,Math.max(...n)+1,Math.max(...s)+1]}var sm=new Set(["spawner","source","agent"]),Kv=10,rm=i=>[0,1].map(t=>i.reduce((e,n)=>e+n[t],0)/i.length);function om(i){if(i.tag==="zone"){let e=Os(i.attributes.points);return e.length?rm(e):null}let t=[Number.parseFloat(i.attributes.x),Number.parseFloat(i.attributes.y)];return i.tag==="point"&&t.every(Number.isFinite)?t:null}function am(i){return i.children.flatMap((t,e)=>{if(t.tag!=="journey")return[];let{name:n,then:s}=t.attributes,r=t.children.map((c,h)=>[h,om(c)]).filter(([,c])=>c),o=t.children.at(-1),a=o?.tag==="direction"?Number.parseFloat(o.attributes.heading)||0:null,l=i.children.filter(c=>sm.has(c.tag)&&n&&c.attributes.journey===n);return[{path:[e],name:n,stops:r,again:s==="again",heading:a,starts:l.map(Jv).filter(Boolean)}]})}function Jv({tag:i,attributes:t}){if(i==="agent")return[Number.parseFloat(t.x)||0,Number.parseFloat(t.y)||0];let e=Os(t.zone);return e.length?rm(e):null}function lm(i,t){let e=new Set(t.children.filter(r=>r.tag==="journey").map(r=>r.attributes.name)),n=1;for(;e.has(`way${n}`);)n++;let s=i.map(([r,o])=>`  <point x="${ze(r)}" y="${ze(o)}"/>`);return`<journey name="way${n}">
${s.join(`
`)}
</journey>`}function wl(i,t,e){return t.filter(s=>s.length===1&&sm.has(i.node(s)?.tag)).flatMap(s=>{let{attributes:r}=i.node(s),o=["goal","goal-zone"].filter(a=>a in r).map(a=>({path:s,name:a,value:null}));return[{path:s,name:"journey",value:e},...o]})}function cm(i,t,e,n){return i.children.flatMap((s,r)=>{let o=[...t,r];if(s.tag==="zone"){let c=Os(s.attributes.points).map(([h,d])=>`${ze(h+e)},${ze(d+n)}`);return[{path:o,name:"points",value:c.join(" ")}]}if(s.tag!=="point")return[];let[a,l]=om(s)??[0,0];return[{path:o,name:"x",value:ze(a+e)},{path:o,name:"y",value:ze(l+n)}]})}function hm(i,t,e){let n={distance:Kv/e,leg:null};for(let{path:s,stops:r}of i)for(let o=1;o<r.length;o++){let a=Sl(t,r[o-1][1],r[o][1]);a<n.distance&&(n={distance:a,leg:{path:s,position:r[o][0]}})}return n.leg}function Sl([i,t],[e,n],[s,r]){let[o,a]=[s-e,r-n],l=Math.max(0,Math.min(1,((i-e)*o+(t-n)*a)/(o*o+a*a||1)));return Math.hypot(i-e-l*o,t-n-l*a)}function um(i,t,{pixel:e,colour:n,chosen:s}){for(let r of t){let o=s.some(h=>h[0]===r.path[0]);i.strokeStyle=i.fillStyle=n(o?"--focus":"--data-4");let a=r.stops.map(([,h])=>e(h)),l=a[0];if(!l)continue;im(i,r.starts.map(h=>[e(h),l]),1,[2,4]);let c=a.slice(1).map((h,d)=>[a[d],h]);if(r.again&&a.length>1&&c.push([a.at(-1),l]),r.heading!==null){let[h,d]=a.at(-1);c.push([[h,d],[h+60*Math.cos(r.heading),d-60*Math.sin(r.heading)]])}im(i,c,o?3:2,[]);for(let h of c)jv(i,h);i.font="bold 11px system-ui, sans-serif",i.strokeStyle=n("--paper"),i.lineWidth=4,a.forEach(([h,d],u)=>{let p=u?String(u+1):`${r.name??""} 1`;i.strokeText(p,h+8,d-8),i.fillText(p,h+8,d-8)})}}function im(i,t,e,n){i.lineWidth=e,i.setLineDash(n),i.beginPath();for(let[s,r]of t)i.moveTo(...s),i.lineTo(...r);i.stroke(),i.setLineDash([])}function jv(i,[[t,e],[n,s]]){let r=Math.atan2(s-e,n-t),[o,a]=[(t+n)/2,(e+s)/2];i.beginPath(),i.moveTo(o+7*Math.cos(r),a+7*Math.sin(r));for(let l of[2.6,-2.6])i.lineTo(o+7*Math.cos(r+l),a+7*Math.sin(r+l));i.fill()}var Qv=i=>i===""?void 0:i,Ml=class{constructor(t,e){Object.assign(this,{root:t,model:e})}update(){let{model:t}=this,e=document.activeElement?.closest?.(".inspector")?document.activeElement.name:null,n=t.chosen[0]??[],s=t.node(n);if(!s)return pt(this.root,f("p",{},"The text is not well-formed XML; correct it in the XML pane."));if(t.chosen.length>1)return this.several();let r=t.kind(n),o=[...r?.attributes??[],...r?.types?.[s.attributes.type]?.attributes??[]];pt(this.root,f("h3",{},`<${s.tag}>`),f("p",{class:"note"},r?.about??""),this.problems(n),r?.types?this.type(n,s,r.types):null,o.map(a=>this.control(n,s,a)),this.children(n,r),this.buttons(n,s)),e&&this.root.querySelector(`[name="${CSS.escape(e)}"]`)?.focus()}problems(t){let e=this.model.state.problems.filter(n=>n.path&&n.path.join()===t.join());return e.length?f("ul",{class:"problems"},e.map(n=>f("li",{},n.message))):null}several(){let{model:t}=this,e=t.chosen.every(n=>t.node(n)?.tag==="agent");pt(this.root,f("h3",{},`${t.chosen.length} elements`),f("div",{class:"row"},e?f("button",{type:"button",onclick:()=>t.edit("gather",{paths:t.chosen})},"Make a spawner"):null,f("button",{type:"button",onclick:()=>t.edit("remove",{paths:t.chosen})},"Remove")))}type(t,e,n){let r=["",...e.attributes.type in n||!e.attributes.type?[]:[e.attributes.type],...Object.keys(n)],o=f("select",{name:"type",onchange:()=>this.set(t,"type",o.value)},r.map(a=>f("option",{value:a,selected:a===(e.attributes.type??"")},a||"default")));return this.field("type",n[e.attributes.type]?.about,o)}control(t,e,n){let s=e.attributes[n.name],r=c=>this.set(t,n.name,c===void 0||c===""?null:c),o=`${n.label}${n.unit?` [${n.unit}]`:""}${n.required?" *":""}`,a,l=n.name==="journey"?this.model.state.tree.children.filter(c=>c.tag==="journey").map(c=>c.attributes.name):null;if(l){let c=["",...new Set([...l,...s?[s]:[]])];a=f("select",{name:n.name,onchange:()=>this.follow(t,a.value)},c.map(h=>f("option",{value:h,selected:h===(s??"")},h||"none: to the goal")))}else if(n.kind==="choice"||n.kind==="switch"){let c=n.kind==="switch"?["true","false"]:n.choices,h=s??"";a=f("select",{name:n.name,onchange:()=>r(a.value)},["",...c].map(d=>f("option",{value:d,selected:d===h},d||(n.value===null?"not given":`default (${n.value})`))))}else{let c=n.kind==="number"||n.kind==="whole";a=f("input",{name:n.name,type:"text",inputmode:c?"decimal":"text",value:s??"",placeholder:n.value===null||n.value===void 0?"":String(n.value),onchange:()=>r(Qv(a.value))})}return this.field(o,n.note,a)}field(t,e,n){return f("label",{class:"field",title:e??""},f("span",{},t),n)}follow(t,e){return e?this.model.edit("change",{changes:wl(this.model,[t],e)}):this.set(t,"journey",null)}set(t,e,n){return this.model.edit("change",{changes:[{path:t,name:e,value:n}]})}children(t,e){let n=Object.keys(e?.children??{});if(!n.length)return null;let s=f("select",{name:"child","aria-label":"Element to add"},n.map(o=>f("option",{},o)));return f("div",{class:"row"},s,f("button",{type:"button",onclick:()=>this.model.insert(t,this.blank(e.children[s.value],s.value))},"Add inside"))}blank(t,e){let n=this.model.table[t],s=(n?.attributes??[]).filter(r=>r.required).map(r=>` ${r.name}="${tx(r)}"`);return n?.types&&e!=="crowd"&&s.push(` type="${Object.keys(n.types)[0]}"`),e==="crowd"&&s.push(' type="people"'),e==="robot"?`<robot${s.join("")}>
  <goal x="0" y="0"/>
  <drive type="differential-drive"/>
  <navigator type="orca"/>
</robot>`:`<${e}${s.join("")}/>`}buttons(t,e){if(!t.length)return null;let{model:n}=this,s=Number(n.state.tree.attributes.seed??0);return f("div",{class:"row"},e.tag==="spawner"?f("button",{type:"button",onclick:()=>n.edit("expand",{path:t,seed:s})},"Make single people"):null,f("button",{type:"button",onclick:()=>n.edit("remove",{paths:[t]})},"Remove"))}},tx=i=>i.kind==="points"?"0,0 1,0 1,1 0,1":i.kind==="choice"?i.choices[0]:i.kind==="number"||i.kind==="whole"||i.kind==="distribution"?Math.max(i.low??1,1):i.name==="name"?"new":"";var El=class extends EventTarget{constructor(t){super(),this.connection=t,this.state=null,this.table=null,this.chosen=[],this.people=null,this.places=!1,t.on("editor.state",e=>this.take(e))}take(t){this.state&&t.revision<this.state.revision||(this.state=t,this.chosen=this.chosen.filter(e=>this.node(e)),this.places||(this.people=null),this.emit("state"),this.places&&!t.problems.length&&this.preview())}emit(t){this.dispatchEvent(new Event(t))}on(t,e){this.addEventListener(t,e)}node(t){return t.reduce((e,n)=>e?.children[n],this.state?.tree??void 0)}kind(t){let e=this.table?.Trial,n=this.state?.tree;for(let s of t)n=n?.children[s],e=this.table?.[e?.children[n?.tag]];return e}choose(t){this.chosen=t,this.emit("chosen")}call(t,e={}){return he(()=>this.connection.call(`editor.${t}`,e))}async edit(t,e={}){let n=await this.call(t,{...e,revision:this.state.revision});return n&&this.take(n),n}async insert(t,e){await this.edit("insert",{path:t,xml:e})&&this.choose([[...t,this.node(t).children.length-1]])}async step(t,e={}){let n=await this.call(t,e);n&&this.take(n)}async showPlaces(t){if(this.places=t,t)return this.preview();this.people=null,this.emit("people")}async preview(){let t=this.state.revision,e=await this.call("preview");t!==this.state.revision||!this.places||(this.people=e,this.emit("people"))}},hs=(i,t)=>i.length===t.length&&i.every((e,n)=>e===t[n]);var Tl=class{constructor(t,e){Object.assign(this,{root:t,model:e}),t.setAttribute("role","listbox"),t.setAttribute("aria-label","Elements"),t.setAttribute("aria-multiselectable","true"),t.tabIndex=0,t.addEventListener("keydown",n=>this.press(n))}update(){let t=this.model.state.tree;this.paths=t?dm(t):[],pt(this.root,this.paths.map((n,s)=>this.row(n,s)));let e=this.paths.findIndex(n=>this.isChosen(n));e>=0&&(this.root.setAttribute("aria-activedescendant",`element-${e}`),this.root.children[e].scrollIntoView({block:"nearest"}))}row(t,e){let n=this.model.node(t),{name:s,type:r,count:o}=n.attributes,a=this.model.state.problems.some(c=>c.path&&hs(c.path,t)),l=[n.tag,s,r,o&&`${o} people`,a&&"has a problem"].filter(Boolean).join(" ");return f("div",{role:"option",id:`element-${e}`,"aria-selected":String(this.isChosen(t)),class:a?"wrong":"",style:`padding-left:${8+14*t.length}px`,onclick:c=>this.choose(t,c.shiftKey||c.ctrlKey)},l)}isChosen(t){return this.model.chosen.some(e=>hs(e,t))}choose(t,e){let n=e?this.model.chosen.filter(s=>!hs(s,t)):[];this.model.choose([...n,t])}press(t){let e=this.paths.findIndex(s=>this.isChosen(s)),n={ArrowDown:e+1,ArrowUp:e-1,Home:0,End:this.paths.length-1}[t.key];n!==void 0&&this.paths[n]?(t.preventDefault(),this.choose(this.paths[n],t.shiftKey)):t.key==="Delete"&&this.model.chosen.some(s=>s.length)&&(t.preventDefault(),this.model.edit("remove",{paths:this.model.chosen.filter(s=>s.length)}))}};function dm(i,t=[]){return[t,...i.children.flatMap((e,n)=>dm(e,[...t,n]))]}var ex="uplot",nx="u-hz",ix="u-vt",sx="u-title",rx="u-wrap",ox="u-under",ax="u-over",lx="u-axis",_r="u-off",cx="u-select",hx="u-cursor-x",ux="u-cursor-y",dx="u-cursor-pt",fx="u-legend",px="u-live",mx="u-inline",gx="u-series",_x="u-marker",fm="u-label",yx="u-value",ia="width",sa="height";var pm="bottom",Kr="left",Gu="right",rd="#000",mm=rd+"0",Vu="mousemove",gm="mousedown",Wu="mouseup",_m="mouseenter",ym="mouseleave",vm="dblclick",vx="resize",xx="scroll",xm="change",Il="dppxchange",od="--",io=typeof window<"u",Zu=io?document:null,jr=io?window:null,bx=io?navigator:null,Ae,Al;function Ku(){let i=devicePixelRatio;Ae!=i&&(Ae=i,Al&&ju(xm,Al,Ku),Al=matchMedia(`(min-resolution: ${Ae-.001}dppx) and (max-resolution: ${Ae+.001}dppx)`),yr(xm,Al,Ku),jr.dispatchEvent(new CustomEvent(Il)))}function mi(i,t){if(t!=null){let e=i.classList;!e.contains(t)&&e.add(t)}}function Ju(i,t){let e=i.classList;e.contains(t)&&e.remove(t)}function Ze(i,t,e){i.style[t]=e+"px"}function Di(i,t,e,n){let s=Zu.createElement(i);return t!=null&&mi(s,t),e?.insertBefore(s,n),s}function Mi(i,t){return Di("div",i,t)}var bm=new WeakMap;function Ji(i,t,e,n,s){let r="translate("+t+"px,"+e+"px)",o=bm.get(i);r!=o&&(i.style.transform=r,bm.set(i,r),t<0||e<0||t>n||e>s?mi(i,_r):Ju(i,_r))}var wm=new WeakMap;function Sm(i,t,e){let n=t+e,s=wm.get(i);n!=s&&(wm.set(i,n),i.style.background=t,i.style.borderColor=e)}var Mm=new WeakMap;function Em(i,t,e,n){let s=t+""+e,r=Mm.get(i);s!=r&&(Mm.set(i,s),i.style.height=e+"px",i.style.width=t+"px",i.style.marginLeft=n?-t/2+"px":0,i.style.marginTop=n?-e/2+"px":0)}var ad={passive:!0},wx={...ad,capture:!0};function yr(i,t,e,n){t.addEventListener(i,e,n?wx:ad)}function ju(i,t,e,n){t.removeEventListener(i,e,ad)}io&&Ku();function Ni(i,t,e,n){let s;e=e||0,n=n||t.length-1;let r=n<=2147483647;for(;n-e>1;)s=r?e+n>>1:gi((e+n)/2),t[s]<i?e=s:n=s;return i-t[e]<=t[n]-i?e:n}function Qm(i){return(e,n,s)=>{let r=-1,o=-1;for(let a=n;a<=s;a++)if(i(e[a])){r=a;break}for(let a=s;a>=n;a--)if(i(e[a])){o=a;break}return[r,o]}}var tg=i=>i!=null,eg=i=>i!=null&&i>0,Nl=Qm(tg),Sx=Qm(eg);function Mx(i,t,e,n=0,s=!1){let r=s?Sx:Nl,o=s?eg:tg;[t,e]=r(i,t,e);let a=i[t],l=i[t];if(t>-1)if(n==1)a=i[t],l=i[e];else if(n==-1)a=i[e],l=i[t];else for(let c=t;c<=e;c++){let h=i[c];o(h)&&(h<a?a=h:h>l&&(l=h))}return[a??He,l??-He]}function Ul(i,t,e,n){let s=Rm(i),r=Rm(t);i==t&&(s==-1?(i*=e,t/=e):(i/=e,t*=e));let o=e==10?us:ng,a=s==1?gi:Ei,l=r==1?Ei:gi,c=a(o(An(i))),h=l(o(An(t))),d=Qr(e,c),u=Qr(e,h);return e==10&&(c<0&&(d=Ge(d,-c)),h<0&&(u=Ge(u,-h))),n||e==2?(i=d*s,t=u*r):(i=og(i,d),t=Fl(t,u)),[i,t]}function ld(i,t,e,n){let s=Ul(i,t,e,n);return i==0&&(s[0]=0),t==0&&(s[1]=0),s}var cd=.1,Tm={mode:3,pad:cd},oa={pad:0,soft:null,mode:0},Ex={min:oa,max:oa};function Ll(i,t,e,n){return Ol(e)?Am(i,t,e):(oa.pad=e,oa.soft=n?0:null,oa.mode=n?3:0,Am(i,t,Ex))}function Me(i,t){return i??t}function Tx(i,t,e){for(t=Me(t,0),e=Me(e,i.length-1);t<=e;){if(i[t]!=null)return!0;t++}return!1}function Am(i,t,e){let n=e.min,s=e.max,r=Me(n.pad,0),o=Me(s.pad,0),a=Me(n.hard,-He),l=Me(s.hard,He),c=Me(n.soft,He),h=Me(s.soft,-He),d=Me(n.mode,0),u=Me(s.mode,0),p=t-i,m=us(p),x=ri(An(i),An(t)),g=us(x),_=An(g-m);(p<1e-24||_>10)&&(p=0,(i==0||t==0)&&(p=1e-24,d==2&&c!=He&&(r=0),u==2&&h!=-He&&(o=0)));let b=p||x||1e3,S=us(b),y=Qr(10,gi(S)),C=b*(p==0?i==0?.1:1:r),E=Ge(og(i-C,y/10),24),v=i>=c&&(d==1||d==3&&E<=c||d==2&&E>=c)?c:He,T=ri(a,E<v&&i>=v?v:Ui(v,E)),F=b*(p==0?t==0?.1:1:o),L=Ge(Fl(t+F,y/10),24),D=t<=h&&(u==1||u==3&&L>=h||u==2&&L<=h)?h:-He,B=Ui(l,L>D&&t<=D?D:ri(D,L));return T==B&&T==0&&(B=100),[T,B]}var Ax=new Intl.NumberFormat(io?bx.language:"en-US"),hd=i=>Ax.format(i),_i=Math,Pl=_i.PI,An=_i.abs,gi=_i.floor,Tn=_i.round,Ei=_i.ceil,Ui=_i.min,ri=_i.max,Qr=_i.pow,Rm=_i.sign,us=_i.log10,ng=_i.log2,Rx=(i,t=1)=>_i.sinh(i)*t,$u=(i,t=1)=>_i.asinh(i/t),He=1/0;function Cm(i){return(us((i^i>>31)-(i>>31))|0)+1}function Qu(i,t,e){return Ui(ri(i,t),e)}function ig(i){return typeof i=="function"}function ve(i){return ig(i)?i:()=>i}var Cx=()=>{},sg=i=>i,rg=(i,t)=>t,Px=i=>null,Pm=i=>!0,Im=(i,t)=>i==t,Ix=/\.\d*?(?=9{6,}|0{6,})/gm,vr=i=>{if(lg(i)||Bs.has(i))return i;let t=`${i}`,e=t.match(Ix);if(e==null)return i;let n=e[0].length-1;if(t.indexOf("e-")!=-1){let[s,r]=t.split("e");return+`${vr(s)}e${r}`}return Ge(i,n)};function mr(i,t){return vr(Ge(vr(i/t))*t)}function Fl(i,t){return vr(Ei(vr(i/t))*t)}function og(i,t){return vr(gi(vr(i/t))*t)}function Ge(i,t=0){if(lg(i))return i;let e=10**t,n=i*e*(1+Number.EPSILON);return Tn(n)/e}var Bs=new Map;function ag(i){return((""+i).split(".")[1]||"").length}function la(i,t,e,n){let s=[],r=n.map(ag);for(let o=t;o<e;o++){let a=An(o),l=Ge(Qr(i,o),a);for(let c=0;c<n.length;c++){let h=i==10?+`${n[c]}e${o}`:n[c]*l,d=(o>=0?0:a)+(o>=r[c]?0:r[c]),u=i==10?h:Ge(h,d);s.push(u),Bs.set(u,d)}}return s}var aa={},ud=[],to=[null,null],ks=Array.isArray,lg=Number.isInteger,Lx=i=>i===void 0;function Lm(i){return typeof i=="string"}function Ol(i){let t=!1;if(i!=null){let e=i.constructor;t=e==null||e==Object}return t}function Dx(i){return i!=null&&typeof i=="object"}var Nx=Object.getPrototypeOf(Uint8Array),cg="__proto__";function eo(i,t=Ol){let e;if(ks(i)){let n=i.find(s=>s!=null);if(ks(n)||t(n)){e=Array(i.length);for(let s=0;s<i.length;s++)e[s]=eo(i[s],t)}else e=i.slice()}else if(i instanceof Nx)e=i.slice();else if(t(i)){e={};for(let n in i)n!=cg&&(e[n]=eo(i[n],t))}else e=i;return e}function bn(i){let t=arguments;for(let e=1;e<t.length;e++){let n=t[e];for(let s in n)s!=cg&&(Ol(i[s])?bn(i[s],eo(n[s])):i[s]=eo(n[s]))}return i}var Ux=0,Fx=1,Ox=2;function kx(i,t,e){for(let n=0,s,r=-1;n<t.length;n++){let o=t[n];if(o>r){for(s=o-1;s>=0&&i[s]==null;)i[s--]=null;for(s=o+1;s<e&&i[s]==null;)i[r=s++]=null}}}function Bx(i,t){if(Gx(i)){let o=i[0].slice();for(let a=1;a<i.length;a++)o.push(...i[a].slice(1));return Vx(o[0])||(o=Hx(o)),o}let e=new Set;for(let o=0;o<i.length;o++){let l=i[o][0],c=l.length;for(let h=0;h<c;h++)e.add(l[h])}let n=[Array.from(e).sort((o,a)=>o-a)],s=n[0].length,r=new Map;for(let o=0;o<s;o++)r.set(n[0][o],o);for(let o=0;o<i.length;o++){let a=i[o],l=a[0];for(let c=1;c<a.length;c++){let h=a[c],d=Array(s).fill(void 0),u=t?t[o][c]:Fx,p=[];for(let m=0;m<h.length;m++){let x=h[m],g=r.get(l[m]);x===null?u!=Ux&&(d[g]=x,u==Ox&&p.push(g)):d[g]=x}kx(d,p,s),n.push(d)}}return n}var zx=typeof queueMicrotask>"u"?i=>Promise.resolve().then(i):queueMicrotask;function Hx(i){let t=i[0],e=t.length,n=Array(e);for(let r=0;r<n.length;r++)n[r]=r;n.sort((r,o)=>t[r]-t[o]);let s=[];for(let r=0;r<i.length;r++){let o=i[r],a=Array(e);for(let l=0;l<e;l++)a[l]=o[n[l]];s.push(a)}return s}function Gx(i){let t=i[0][0],e=t.length;for(let n=1;n<i.length;n++){let s=i[n][0];if(s.length!=e)return!1;if(s!=t){for(let r=0;r<e;r++)if(s[r]!=t[r])return!1}}return!0}function Vx(i,t=100){let e=i.length;if(e<=1)return!0;let n=0,s=e-1;for(;n<=s&&i[n]==null;)n++;for(;s>=n&&i[s]==null;)s--;if(s<=n)return!0;let r=ri(1,gi((s-n+1)/t));for(let o=i[n],a=n+r;a<=s;a+=r){let l=i[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var hg=["January","February","March","April","May","June","July","August","September","October","November","December"],ug=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function dg(i){return i.slice(0,3)}var Wx=ug.map(dg),$x=hg.map(dg),Xx={MMMM:hg,MMM:$x,WWWW:ug,WWW:Wx};function na(i){return(i<10?"0":"")+i}function qx(i){return(i<10?"00":i<100?"0":"")+i}var Yx={YYYY:i=>i.getFullYear(),YY:i=>(i.getFullYear()+"").slice(2),MMMM:(i,t)=>t.MMMM[i.getMonth()],MMM:(i,t)=>t.MMM[i.getMonth()],MM:i=>na(i.getMonth()+1),M:i=>i.getMonth()+1,DD:i=>na(i.getDate()),D:i=>i.getDate(),WWWW:(i,t)=>t.WWWW[i.getDay()],WWW:(i,t)=>t.WWW[i.getDay()],HH:i=>na(i.getHours()),H:i=>i.getHours(),h:i=>{let t=i.getHours();return t==0?12:t>12?t-12:t},AA:i=>i.getHours()>=12?"PM":"AM",aa:i=>i.getHours()>=12?"pm":"am",a:i=>i.getHours()>=12?"p":"a",mm:i=>na(i.getMinutes()),m:i=>i.getMinutes(),ss:i=>na(i.getSeconds()),s:i=>i.getSeconds(),fff:i=>qx(i.getMilliseconds())};function dd(i,t){t=t||Xx;let e=[],n=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=n.exec(i);)e.push(s[0][0]=="{"?Yx[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<e.length;a++)o+=typeof e[a]=="string"?e[a]:e[a](r,t);return o}}var Zx=new Intl.DateTimeFormat().resolvedOptions().timeZone;function Kx(i,t){let e;return t=="UTC"||t=="Etc/UTC"?e=new Date(+i+i.getTimezoneOffset()*6e4):t==Zx?e=i:(e=new Date(i.toLocaleString("en-US",{timeZone:t})),e.setMilliseconds(i.getMilliseconds())),e}var fg=i=>i%1==0,Dl=[1,2,2.5,5],Jx=la(10,-32,0,Dl),pg=la(10,0,32,Dl),jx=pg.filter(fg),gr=Jx.concat(pg),fd=`
`,mg="{YYYY}",Dm=fd+mg,gg="{M}/{D}",ra=fd+gg,Rl=ra+"/{YY}",_g="{aa}",Qx="{h}:{mm}",Jr=Qx+_g,Nm=fd+Jr,Um=":{ss}",Ce=null;function yg(i){let t=i*1e3,e=t*60,n=e*60,s=n*24,r=s*30,o=s*365,l=(i==1?la(10,0,3,Dl).filter(fg):la(10,-3,0,Dl)).concat([t,t*5,t*10,t*15,t*30,e,e*5,e*10,e*15,e*30,n,n*2,n*3,n*4,n*6,n*8,n*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,mg,Ce,Ce,Ce,Ce,Ce,Ce,1],[s*28,"{MMM}",Dm,Ce,Ce,Ce,Ce,Ce,1],[s,gg,Dm,Ce,Ce,Ce,Ce,Ce,1],[n,"{h}"+_g,Rl,Ce,ra,Ce,Ce,Ce,1],[e,Jr,Rl,Ce,ra,Ce,Ce,Ce,1],[t,Um,Rl+" "+Jr,Ce,ra+" "+Jr,Ce,Nm,Ce,1],[i,Um+".{fff}",Rl+" "+Jr,Ce,ra+" "+Jr,Ce,Nm,Ce,1]];function h(d){return(u,p,m,x,g,_)=>{let b=[],S=g>=o,y=g>=r&&g<o,C=d(m),E=Ge(C*i,3),v=Xu(C.getFullYear(),S?0:C.getMonth(),y||S?1:C.getDate()),T=Ge(v*i,3);if(y||S){let F=y?g/r:0,L=S?g/o:0,D=E==T?E:Ge(Xu(v.getFullYear()+L,v.getMonth()+F,1)*i,3),B=new Date(Tn(D/i)),G=B.getFullYear(),N=B.getMonth();for(let W=0;D<=x;W++){let q=Xu(G+L*W,N+F*W,1),V=q-d(Ge(q*i,3));D=Ge((+q+V)*i,3),D<=x&&b.push(D)}}else{let F=g>=s?s:g,L=gi(m)-gi(E),D=T+L+Fl(E-T,F);b.push(D);let B=d(D),G=B.getHours()+B.getMinutes()/e+B.getSeconds()/n,N=g/n,W=u.axes[p]._space,q=_/W;for(;D=Ge(D+g,i==1?0:3),!(D>x);)if(N>1){let V=gi(Ge(G+N,6))%24,j=d(D).getHours()-V;j>1&&(j=-1),D-=j*n,G=(G+N)%24;let et=b[b.length-1];Ge((D-et)/g,3)*q>=.7&&b.push(D)}else b.push(D)}return b}}return[l,c,h]}var[tb,eb,nb]=yg(1),[ib,sb,rb]=yg(.001);la(2,-53,53,[1]);function Fm(i,t){return i.map(e=>e.map((n,s)=>s==0||s==8||n==null?n:t(s==1||e[8]==0?n:e[1]+n)))}function Om(i,t){return(e,n,s,r,o)=>{let a=t.find(m=>o>=m[0])||t[t.length-1],l,c,h,d,u,p;return n.map(m=>{let x=i(m),g=x.getFullYear(),_=x.getMonth(),b=x.getDate(),S=x.getHours(),y=x.getMinutes(),C=x.getSeconds(),E=g!=l&&a[2]||_!=c&&a[3]||b!=h&&a[4]||S!=d&&a[5]||y!=u&&a[6]||C!=p&&a[7]||a[1];return l=g,c=_,h=b,d=S,u=y,p=C,E(x)})}}function ob(i,t){let e=dd(t);return(n,s,r,o,a)=>s.map(l=>e(i(l)))}function Xu(i,t,e){return new Date(i,t,e)}function km(i,t){return t(i)}var ab="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function Bm(i,t){return(e,n,s,r)=>r==null?od:t(i(n))}function lb(i,t){let e=i.series[t];return e.width?e.stroke(i,t):e.points.width?e.points.stroke(i,t):null}function cb(i,t){return i.series[t].fill(i,t)}var hb={show:!0,live:!0,isolate:!1,mount:Cx,markers:{show:!0,width:2,stroke:lb,fill:cb,dash:"solid"},idx:null,idxs:null,values:[]};function ub(i,t){let e=i.cursor.points,n=Mi(),s=e.size(i,t);Ze(n,ia,s),Ze(n,sa,s);let r=s/-2;Ze(n,"marginLeft",r),Ze(n,"marginTop",r);let o=e.width(i,t,s);return o&&Ze(n,"borderWidth",o),n}function db(i,t){let e=i.series[t].points;return e._fill||e._stroke}function fb(i,t){let e=i.series[t].points;return e._stroke||e._fill}function pb(i,t){return i.series[t].points.size}var qu=[0,0];function mb(i,t,e){return qu[0]=t,qu[1]=e,qu}function Cl(i,t,e,n=!0){return s=>{s.button==0&&(!n||s.target==t)&&e(s)}}function Yu(i,t,e,n=!0){return s=>{(!n||s.target==t)&&e(s)}}var gb={show:!0,x:!0,y:!0,lock:!1,move:mb,points:{one:!1,show:ub,size:pb,width:0,stroke:fb,fill:db},bind:{mousedown:Cl,mouseup:Cl,click:Cl,dblclick:Cl,mousemove:Yu,mouseleave:Yu,mouseenter:Yu},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(i,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(i,t,e,n,s)=>n-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},vg={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},pd=bn({},vg,{filter:rg}),xg=bn({},pd,{size:10}),bg=bn({},vg,{show:!1}),md='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',wg="bold "+md,Sg=1.5,zm={show:!0,scale:"x",stroke:rd,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:wg,side:2,grid:pd,ticks:xg,border:bg,font:md,lineGap:Sg,rotate:0},_b="Value",yb="Time",Hm={show:!0,scale:"x",auto:!1,sorted:1,min:He,max:-He,idxs:[]};function vb(i,t,e,n,s){return t.map(r=>r==null?"":hd(r))}function xb(i,t,e,n,s,r,o){let a=[],l=Bs.get(s)||0;e=o?e:Ge(Fl(e,s),l);for(let c=e;c<=n;c=Ge(c+s,l))a.push(Object.is(c,-0)?0:c);return a}function td(i,t,e,n,s,r,o){let a=[],l=i.scales[i.axes[t].scale].log,c=l==10?us:ng,h=gi(c(e));s=Qr(l,h),l==10&&(s=gr[Ni(s,gr)]);let d=e,u=s*l;l==10&&(u=gr[Ni(u,gr)]);do a.push(d),d=d+s,l==10&&!Bs.has(d)&&(d=Ge(d,Bs.get(s))),d>=u&&(s=d,u=s*l,l==10&&(u=gr[Ni(u,gr)]));while(d<=n);return a}function bb(i,t,e,n,s,r,o){let l=i.scales[i.axes[t].scale].asinh,c=n>l?td(i,t,ri(l,e),n,s):[l],h=n>=0&&e<=0?[0]:[];return(e<-l?td(i,t,ri(l,-n),-e,s):[l]).reverse().map(u=>-u).concat(h,c)}var Mg=/./,wb=/[12357]/,Sb=/[125]/,Gm=/1/,ed=(i,t,e,n)=>i.map((s,r)=>t==4&&s==0||r%n==0&&e.test(s.toExponential()[s<0?1:0])?s:null);function Mb(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=i.scales[o],l=i.valToPos,c=r._space,h=l(10,o),d=l(9,o)-h>=c?Mg:l(7,o)-h>=c?wb:l(5,o)-h>=c?Sb:Gm;if(d==Gm){let u=An(l(1,o)-h);if(u<c)return ed(t.slice().reverse(),a.distr,d,Ei(c/u)).reverse()}return ed(t,a.distr,d,1)}function Eb(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=r._space,l=i.valToPos,c=An(l(1,o)-l(2,o));return c<a?ed(t.slice().reverse(),3,Mg,Ei(a/c)).reverse():t}function Tb(i,t,e,n){return n==null?od:t==null?"":hd(t)}var Vm={show:!0,scale:"y",stroke:rd,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:wg,side:3,grid:pd,ticks:xg,border:bg,font:md,lineGap:Sg,rotate:0};function Ab(i,t){let e=3+(i||1)*2;return Ge(e*t,3)}function Rb(i,t){let{scale:e,idxs:n}=i.series[0],s=i._data[0],r=i.valToPos(s[n[0]],e,!0),o=i.valToPos(s[n[1]],e,!0),a=An(o-r),l=i.series[t],c=a/(l.points.space*Ae);return n[1]-n[0]<=c}var Wm={scale:null,auto:!0,sorted:0,min:He,max:-He},Eg=(i,t,e,n,s)=>s,$m={show:!0,auto:!0,sorted:0,gaps:Eg,alpha:1,facets:[bn({},Wm,{scale:"x"}),bn({},Wm,{scale:"y"})]},Xm={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Eg,alpha:1,points:{show:Rb,filter:null},values:null,min:He,max:-He,idxs:[],path:null,clip:null};function Cb(i,t,e,n,s){return e/10}var Tg={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Pb=bn({},Tg,{time:!1,ori:1}),qm={};function Ag(i,t){let e=qm[i];return e||(e={key:i,plots:[],sub(n){e.plots.push(n)},unsub(n){e.plots=e.plots.filter(s=>s!=n)},pub(n,s,r,o,a,l,c){for(let h=0;h<e.plots.length;h++)e.plots[h]!=s&&e.plots[h].pub(n,s,r,o,a,l,c)}},i!=null&&(qm[i]=e)),e}var no=1,nd=2;function xr(i,t,e){let n=i.mode,s=i.series[t],r=n==2?i._data[t]:i._data,o=i.scales,a=i.bbox,l=r[0],c=n==2?r[1]:r[t],h=n==2?o[s.facets[0].scale]:o[i.series[0].scale],d=n==2?o[s.facets[1].scale]:o[s.scale],u=a.left,p=a.top,m=a.width,x=a.height,g=i.valToPosH,_=i.valToPosV;return h.ori==0?e(s,l,c,h,d,g,_,u,p,m,x,Bl,so,Hl,Cg,Ig):e(s,l,c,h,d,_,g,p,u,x,m,zl,ro,yd,Pg,Lg)}function gd(i,t){let e=0,n=0,s=Me(i.bands,ud);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==t?e=o.dir:o.series[1]==t&&(o.dir==1?n|=1:n|=2)}return[e,n==1?-1:n==2?1:n==3?2:0]}function Ib(i,t,e,n,s){let r=i.mode,o=i.series[t],a=r==2?o.facets[1].scale:o.scale,l=i.scales[a];return s==-1?l.min:s==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function ds(i,t,e,n,s,r){return xr(i,t,(o,a,l,c,h,d,u,p,m,x,g)=>{let _=o.pxRound,b=c.dir*(c.ori==0?1:-1),S=c.ori==0?so:ro,y,C;b==1?(y=e,C=n):(y=n,C=e);let E=_(d(a[y],c,x,p)),v=_(u(l[y],h,g,m)),T=_(d(a[C],c,x,p)),F=_(u(r==1?h.max:h.min,h,g,m)),L=new Path2D(s);return S(L,T,F),S(L,E,F),S(L,E,v),L})}function kl(i,t,e,n,s,r){let o=null;if(i.length>0){o=new Path2D;let a=t==0?Hl:yd,l=e;for(let d=0;d<i.length;d++){let u=i[d];if(u[1]>u[0]){let p=u[0]-l;p>0&&a(o,l,n,p,n+r),l=u[1]}}let c=e+s-l,h=10;c>0&&a(o,l,n-h/2,c,n+r+h)}return o}function Lb(i,t,e){let n=i[i.length-1];n&&n[0]==t?n[1]=e:i.push([t,e])}function _d(i,t,e,n,s,r,o){let a=[],l=i.length;for(let c=s==1?e:n;c>=e&&c<=n;c+=s)if(t[c]===null){let d=c,u=c;if(s==1)for(;++c<=n&&t[c]===null;)u=c;else for(;--c>=e&&t[c]===null;)u=c;let p=r(i[d]),m=u==d?p:r(i[u]),x=d-s;p=o<=0&&x>=0&&x<l?r(i[x]):p;let _=u+s;m=o>=0&&_>=0&&_<l?r(i[_]):m,m>=p&&a.push([p,m])}return a}function Ym(i){return i==0?sg:i==1?Tn:t=>mr(t,i)}function Rg(i){let t=i==0?Bl:zl,e=i==0?(s,r,o,a,l,c)=>{s.arcTo(r,o,a,l,c)}:(s,r,o,a,l,c)=>{s.arcTo(o,r,l,a,c)},n=i==0?(s,r,o,a,l)=>{s.rect(r,o,a,l)}:(s,r,o,a,l)=>{s.rect(o,r,l,a)};return(s,r,o,a,l,c=0,h=0)=>{c==0&&h==0?n(s,r,o,a,l):(c=Ui(c,a/2,l/2),h=Ui(h,a/2,l/2),t(s,r+c,o),e(s,r+a,o,r+a,o+l,c),e(s,r+a,o+l,r,o+l,h),e(s,r,o+l,r,o,h),e(s,r,o,r+a,o,c),s.closePath())}}var Bl=(i,t,e)=>{i.moveTo(t,e)},zl=(i,t,e)=>{i.moveTo(e,t)},so=(i,t,e)=>{i.lineTo(t,e)},ro=(i,t,e)=>{i.lineTo(e,t)},Hl=Rg(0),yd=Rg(1),Cg=(i,t,e,n,s,r)=>{i.arc(t,e,n,s,r)},Pg=(i,t,e,n,s,r)=>{i.arc(e,t,n,s,r)},Ig=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(t,e,n,s,r,o)},Lg=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(e,t,s,n,o,r)};function Dg(i){return(t,e,n,s,r)=>xr(t,e,(o,a,l,c,h,d,u,p,m,x,g)=>{let{pxRound:_,points:b}=o,S,y;c.ori==0?(S=Bl,y=Cg):(S=zl,y=Pg);let C=Ge(b.width*Ae,3),E=(b.size-b.width)/2*Ae,v=Ge(E*2,3),T=new Path2D,F=new Path2D,{left:L,top:D,width:B,height:G}=t.bbox;Hl(F,L-v,D-v,B+v*2,G+v*2);let N=W=>{if(l[W]!=null){let q=_(d(a[W],c,x,p)),V=_(u(l[W],h,g,m));S(T,q+E,V),y(T,q,V,E,0,Pl*2)}};if(r)r.forEach(N);else for(let W=n;W<=s;W++)N(W);return{stroke:C>0?T:null,fill:T,clip:F,flags:no|nd}})}function Ng(i){return(t,e,n,s,r,o)=>{n!=s&&(r!=n&&o!=n&&i(t,e,n),r!=s&&o!=s&&i(t,e,s),i(t,e,o))}}var Db=Ng(so),Nb=Ng(ro);function Ug(i){let t=Me(i?.alignGaps,0);return(e,n,s,r)=>xr(e,n,(o,a,l,c,h,d,u,p,m,x,g)=>{[s,r]=Nl(l,s,r);let _=o.pxRound,b=G=>_(d(G,c,x,p)),S=G=>_(u(G,h,g,m)),y,C;c.ori==0?(y=so,C=Db):(y=ro,C=Nb);let E=c.dir*(c.ori==0?1:-1),v={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:no},T=v.stroke,F=!1;if(r-s>=x*4){let G=ut=>e.posToVal(ut,c.key,!0),N=null,W=null,q,V,lt,Z=b(a[E==1?s:r]),j=b(a[s]),et=b(a[r]),dt=G(E==1?j+1:et-1);for(let ut=E==1?s:r;ut>=s&&ut<=r;ut+=E){let tt=a[ut],vt=(E==1?tt<dt:tt>dt)?Z:b(tt),Rt=l[ut];vt==Z?Rt!=null?(V=Rt,N==null?(y(T,vt,S(V)),q=N=W=V):V<N?N=V:V>W&&(W=V)):Rt===null&&(F=!0):(N!=null&&C(T,Z,S(N),S(W),S(q),S(V)),Rt!=null?(V=Rt,y(T,vt,S(V)),N=W=q=V):(N=W=null,Rt===null&&(F=!0)),Z=vt,dt=G(Z+E))}N!=null&&N!=W&&lt!=Z&&C(T,Z,S(N),S(W),S(q),S(V))}else for(let G=E==1?s:r;G>=s&&G<=r;G+=E){let N=l[G];N===null?F=!0:N!=null&&y(T,b(a[G]),S(N))}let[D,B]=gd(e,n);if(o.fill!=null||D!=0){let G=v.fill=new Path2D(T),N=o.fillTo(e,n,o.min,o.max,D),W=S(N),q=b(a[s]),V=b(a[r]);E==-1&&([V,q]=[q,V]),y(G,V,W),y(G,q,W)}if(!o.spanGaps){let G=[];F&&G.push(..._d(a,l,s,r,E,b,t)),v.gaps=G=o.gaps(e,n,s,r,G),v.clip=kl(G,c.ori,p,m,x,g)}return B!=0&&(v.band=B==2?[ds(e,n,s,r,T,-1),ds(e,n,s,r,T,1)]:ds(e,n,s,r,T,B)),v})}function Ub(i){let t=Me(i.align,1),e=Me(i.ascDesc,!1),n=Me(i.alignGaps,0),s=Me(i.extend,!1);return(r,o,a,l)=>xr(r,o,(c,h,d,u,p,m,x,g,_,b,S)=>{[a,l]=Nl(d,a,l);let y=c.pxRound,{left:C,width:E}=r.bbox,v=j=>y(m(j,u,b,g)),T=j=>y(x(j,p,S,_)),F=u.ori==0?so:ro,L={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:no},D=L.stroke,B=u.dir*(u.ori==0?1:-1),G=T(d[B==1?a:l]),N=v(h[B==1?a:l]),W=N,q=N;s&&t==-1&&(q=C,F(D,q,G)),F(D,N,G);for(let j=B==1?a:l;j>=a&&j<=l;j+=B){let et=d[j];if(et==null)continue;let dt=v(h[j]),ut=T(et);t==1?F(D,dt,G):F(D,W,ut),F(D,dt,ut),G=ut,W=dt}let V=W;s&&t==1&&(V=C+E,F(D,V,G));let[lt,Z]=gd(r,o);if(c.fill!=null||lt!=0){let j=L.fill=new Path2D(D),et=c.fillTo(r,o,c.min,c.max,lt),dt=T(et);F(j,V,dt),F(j,q,dt)}if(!c.spanGaps){let j=[];j.push(..._d(h,d,a,l,B,v,n));let et=c.width*Ae/2,dt=e||t==1?et:-et,ut=e||t==-1?-et:et;j.forEach(tt=>{tt[0]+=dt,tt[1]+=ut}),L.gaps=j=c.gaps(r,o,a,l,j),L.clip=kl(j,u.ori,g,_,b,S)}return Z!=0&&(L.band=Z==2?[ds(r,o,a,l,D,-1),ds(r,o,a,l,D,1)]:ds(r,o,a,l,D,Z)),L})}function Zm(i,t,e,n,s,r,o=He){if(i.length>1){let a=null;for(let l=0,c=1/0;l<i.length;l++)if(t[l]!==void 0){if(a!=null){let h=An(i[l]-i[a]);h<c&&(c=h,o=An(e(i[l],n,s,r)-e(i[a],n,s,r)))}a=l}}return o}function Fb(i){i=i||aa;let t=Me(i.size,[.6,He,1]),e=i.align||0,n=i.gap||0,s=i.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=ve(s),o=1-t[0],a=Me(t[1],He),l=Me(t[2],1),c=Me(i.disp,aa),h=Me(i.each,p=>{}),{fill:d,stroke:u}=c;return(p,m,x,g)=>xr(p,m,(_,b,S,y,C,E,v,T,F,L,D)=>{let B=_.pxRound,G=e,N=n*Ae,W=a*Ae,q=l*Ae,V,lt;y.ori==0?[V,lt]=r(p,m):[lt,V]=r(p,m);let Z=y.dir*(y.ori==0?1:-1),j=y.ori==0?Hl:yd,et=y.ori==0?h:(Pt,Kt,oe,Mt,Be,Ht,qt)=>{h(Pt,Kt,oe,Be,Mt,qt,Ht)},dt=Me(p.bands,ud).find(Pt=>Pt.series[0]==m),ut=dt!=null?dt.dir:0,tt=_.fillTo(p,m,_.min,_.max,ut),gt=B(v(tt,C,D,F)),vt,Rt,St,$t=L,re=B(_.width*Ae),Gt=!1,de=null,le=null,ie=null,Je=null;d!=null&&(re==0||u!=null)&&(Gt=!0,de=d.values(p,m,x,g),le=new Map,new Set(de).forEach(Pt=>{Pt!=null&&le.set(Pt,new Path2D)}),re>0&&(ie=u.values(p,m,x,g),Je=new Map,new Set(ie).forEach(Pt=>{Pt!=null&&Je.set(Pt,new Path2D)})));let{x0:We,size:mn}=c;if(We!=null&&mn!=null){G=1,b=We.values(p,m,x,g),We.unit==2&&(b=b.map(oe=>p.posToVal(T+oe*L,y.key,!0)));let Pt=mn.values(p,m,x,g);mn.unit==2?Rt=Pt[0]*L:Rt=E(Pt[0],y,L,T)-E(0,y,L,T),$t=Zm(b,S,E,y,L,T,$t),St=$t-Rt+N}else $t=Zm(b,S,E,y,L,T,$t),St=$t*o+N,Rt=$t-St;St<1&&(St=0),re>=Rt/2&&(re=0),St<5&&(B=sg);let Oe=St>0,Dn=$t-St-(Oe?re:0);Rt=B(Qu(Dn,q,W)),vt=(G==0?Rt/2:G==Z?0:Rt)-G*Z*((G==0?N/2:0)+(Oe?re/2:0));let be={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},Mn=Gt?null:new Path2D,on=null;if(dt!=null)on=p.data[dt.series[1]];else{let{y0:Pt,y1:Kt}=c;Pt!=null&&Kt!=null&&(S=Kt.values(p,m,x,g),on=Pt.values(p,m,x,g))}let gn=V*Rt,k=lt*Rt;for(let Pt=Z==1?x:g;Pt>=x&&Pt<=g;Pt+=Z){let Kt=S[Pt];if(Kt==null)continue;if(on!=null){let X=on[Pt]??0;if(Kt-X==0)continue;gt=v(X,C,D,F)}let oe=y.distr!=2||c!=null?b[Pt]:Pt,Mt=E(oe,y,L,T),Be=v(Me(Kt,tt),C,D,F),Ht=B(Mt-vt),qt=B(ri(Be,gt)),P=B(Ui(Be,gt)),M=qt-P;if(Kt!=null){let X=Kt<0?k:gn,ht=Kt<0?gn:k;Gt?(re>0&&ie[Pt]!=null&&j(Je.get(ie[Pt]),Ht,P+gi(re/2),Rt,ri(0,M-re),X,ht),de[Pt]!=null&&j(le.get(de[Pt]),Ht,P+gi(re/2),Rt,ri(0,M-re),X,ht)):j(Mn,Ht,P+gi(re/2),Rt,ri(0,M-re),X,ht),et(p,m,Pt,Ht-re/2,P,Rt+re,M)}}return re>0?be.stroke=Gt?Je:Mn:Gt||(be._fill=_.width==0?_._fill:_._stroke??_._fill,be.width=0),be.fill=Gt?le:Mn,be})}function Ob(i,t){let e=Me(t?.alignGaps,0);return(n,s,r,o)=>xr(n,s,(a,l,c,h,d,u,p,m,x,g,_)=>{[r,o]=Nl(c,r,o);let b=a.pxRound,S=V=>b(u(V,h,g,m)),y=V=>b(p(V,d,_,x)),C,E,v;h.ori==0?(C=Bl,v=so,E=Ig):(C=zl,v=ro,E=Lg);let T=h.dir*(h.ori==0?1:-1),F=S(l[T==1?r:o]),L=F,D=[],B=[];for(let V=T==1?r:o;V>=r&&V<=o;V+=T)if(c[V]!=null){let Z=l[V],j=S(Z);D.push(L=j),B.push(y(c[V]))}let G={stroke:i(D,B,C,v,E,b),fill:null,clip:null,band:null,gaps:null,flags:no},N=G.stroke,[W,q]=gd(n,s);if(a.fill!=null||W!=0){let V=G.fill=new Path2D(N),lt=a.fillTo(n,s,a.min,a.max,W),Z=y(lt);v(V,L,Z),v(V,F,Z)}if(!a.spanGaps){let V=[];V.push(..._d(l,c,r,o,T,S,e)),G.gaps=V=a.gaps(n,s,r,o,V),G.clip=kl(V,h.ori,m,x,g,_)}return q!=0&&(G.band=q==2?[ds(n,s,r,o,N,-1),ds(n,s,r,o,N,1)]:ds(n,s,r,o,N,q)),G})}function kb(i){return Ob(Bb,i)}function Bb(i,t,e,n,s,r){let o=i.length;if(o<2)return null;let a=new Path2D;if(e(a,i[0],t[0]),o==2)n(a,i[1],t[1]);else{let l=Array(o),c=Array(o-1),h=Array(o-1),d=Array(o-1);for(let u=0;u<o-1;u++)h[u]=t[u+1]-t[u],d[u]=i[u+1]-i[u],c[u]=h[u]/d[u];l[0]=c[0];for(let u=1;u<o-1;u++)c[u]===0||c[u-1]===0||c[u-1]>0!=c[u]>0?l[u]=0:(l[u]=3*(d[u-1]+d[u])/((2*d[u]+d[u-1])/c[u-1]+(d[u]+2*d[u-1])/c[u]),isFinite(l[u])||(l[u]=0));l[o-1]=c[o-2];for(let u=0;u<o-1;u++)s(a,i[u]+d[u]/3,t[u]+l[u]*d[u]/3,i[u+1]-d[u]/3,t[u+1]-l[u+1]*d[u]/3,i[u+1],t[u+1])}return a}var id=new Set;function Km(){for(let i of id)i.syncRect(!0)}io&&(yr(vx,jr,Km),yr(xx,jr,Km,!0),yr(Il,jr,()=>{Hn.pxRatio=Ae}));var zb=Ug(),Hb=Dg();function Jm(i,t,e,n){return(n?[i[0],i[1]].concat(i.slice(2)):[i[0]].concat(i.slice(1))).map((r,o)=>sd(r,o,t,e))}function Gb(i,t){return i.map((e,n)=>n==0?{}:bn({},t,e))}function sd(i,t,e,n){return bn({},t==0?e:n,i)}function Fg(i,t,e){return t==null?to:[t,e]}var Vb=Fg;function Wb(i,t,e){return t==null?to:Ll(t,e,cd,!0)}function Og(i,t,e,n){return t==null?to:Ul(t,e,i.scales[n].log,!1)}var $b=Og;function kg(i,t,e,n){return t==null?to:ld(t,e,i.scales[n].log,!1)}var Xb=kg;function qb(i,t,e,n,s){let r=ri(Cm(i),Cm(t)),o=t-i,a=Ni(s/n*o,e);do{let l=e[a],c=n*l/o;if(c>=s&&r+(l<5?Bs.get(l):0)<=17)return[l,c]}while(++a<e.length);return[0,0]}function jm(i){let t,e;return i=i.replace(/(\d+)px/,(n,s)=>(t=Tn((e=+s)*Ae))+"px"),[i,t,e]}function Yb(i){i.show&&[i.font,i.labelFont].forEach(t=>{let e=Ge(t[2]*Ae,1);t[0]=t[0].replace(/[0-9.]+px/,e+"px"),t[1]=e})}function Hn(i,t,e){let n={mode:Me(i.mode,1)},s=n.mode;function r(w,A,I,U){let $=A.valToPct(w);return U+I*(A.dir==-1?1-$:$)}function o(w,A,I,U){let $=A.valToPct(w);return U+I*(A.dir==-1?$:1-$)}function a(w,A,I,U){return A.ori==0?r(w,A,I,U):o(w,A,I,U)}n.valToPosH=r,n.valToPosV=o;let l=!1;n.status=0;let c=n.root=Mi(ex);if(i.id!=null&&(c.id=i.id),mi(c,i.class),i.title){let w=Mi(sx,c);w.textContent=i.title}let h=Di("canvas"),d=n.ctx=h.getContext("2d"),u=Mi(rx,c);yr("click",u,w=>{w.target===m&&(Xe!=$r||je!=Xr)&&zn.click(n,w)},!0);let p=n.under=Mi(ox,u);u.appendChild(h);let m=n.over=Mi(ax,u);i=eo(i);let x=+Me(i.pxAlign,1),g=Ym(x);(i.plugins||[]).forEach(w=>{w.opts&&(i=w.opts(n,i)||i)});let _=i.ms||.001,b=n.series=s==1?Jm(i.series||[],Hm,Xm,!1):Gb(i.series||[null],$m),S=n.axes=Jm(i.axes||[],zm,Vm,!0),y=n.scales={},C=n.bands=i.bands||[];C.forEach(w=>{w.fill=ve(w.fill||null),w.dir=Me(w.dir,-1)});let E=s==2?b[1].facets[0].scale:b[0].scale,v={axes:ls,series:pe},T=(i.drawOrder||["axes","series"]).map(w=>v[w]);function F(w){let A=w.distr==3?I=>us(I>0?I:w.clamp(n,I,w.min,w.max,w.key)):w.distr==4?I=>$u(I,w.asinh):w.distr==100?I=>w.fwd(I):I=>I;return I=>{let U=A(I),{_min:$,_max:J}=w,at=J-$;return(U-$)/at}}function L(w){let A=y[w];if(A==null){let I=(i.scales||aa)[w]||aa;if(I.from!=null){L(I.from);let U=bn({},y[I.from],I,{key:w});U.valToPct=F(U),y[w]=U}else{A=y[w]=bn({},w==E?Tg:Pb,I),A.key=w;let U=A.time,$=A.range,J=ks($);if((w!=E||s==2&&!U)&&(J&&($[0]==null||$[1]==null)&&($={min:$[0]==null?Tm:{mode:1,hard:$[0],soft:$[0]},max:$[1]==null?Tm:{mode:1,hard:$[1],soft:$[1]}},J=!1),!J&&Ol($))){let at=$;$=(ft,bt,Nt)=>bt==null?to:Ll(bt,Nt,at)}A.range=ve($||(U?Vb:w==E?A.distr==3?$b:A.distr==4?Xb:Fg:A.distr==3?Og:A.distr==4?kg:Wb)),A.auto=ve(J?!1:A.auto),A.clamp=ve(A.clamp||Cb),A._min=A._max=null,A.valToPct=F(A)}}}L("x"),L("y"),s==1&&b.forEach(w=>{L(w.scale)}),S.forEach(w=>{L(w.scale)});for(let w in i.scales)L(w);let D=y[E],B=D.distr,G,N;D.ori==0?(mi(c,nx),G=r,N=o):(mi(c,ix),G=o,N=r);let W={};for(let w in y){let A=y[w];(A.min!=null||A.max!=null)&&(W[w]={min:A.min,max:A.max},A.min=A.max=null)}let q=i.tzDate||(w=>new Date(Tn(w/_))),V=i.fmtDate||dd,lt=_==1?nb(q):rb(q),Z=Om(q,Fm(_==1?eb:sb,V)),j=Bm(q,km(ab,V)),et=[],dt=n.legend=bn({},hb,i.legend),ut=n.cursor=bn({},gb,{drag:{y:s==2}},i.cursor),tt=dt.show,gt=ut.show,vt=dt.markers;dt.idxs=et,vt.width=ve(vt.width),vt.dash=ve(vt.dash),vt.stroke=ve(vt.stroke),vt.fill=ve(vt.fill);let Rt,St,$t,re=[],Gt=[],de,le=!1,ie={};if(dt.live){let w=b[1]?b[1].values:null;le=w!=null,de=le?w(n,1,0):{_:0};for(let A in de)ie[A]=od}if(tt)if(Rt=Di("table",fx,c),$t=Di("tbody",null,Rt),dt.mount(n,Rt),le){St=Di("thead",null,Rt,$t);let w=Di("tr",null,St);Di("th",null,w);for(var Je in de)Di("th",fm,w).textContent=Je}else mi(Rt,mx),dt.live&&mi(Rt,px);let We={show:!0},mn={show:!1};function Oe(w,A){if(A==0&&(le||!dt.live||s==2))return to;let I=[],U=Di("tr",gx,$t,$t.childNodes[A]);mi(U,w.class),w.show||mi(U,_r);let $=Di("th",null,U);if(vt.show){let ft=Mi(_x,$);if(A>0){let bt=vt.width(n,A);bt&&(ft.style.border=bt+"px "+vt.dash(n,A)+" "+vt.stroke(n,A)),ft.style.background=vt.fill(n,A)}}let J=Mi(fm,$);w.label instanceof HTMLElement?J.appendChild(w.label):J.textContent=w.label,A>0&&(vt.show||(J.style.color=w.width>0?vt.stroke(n,A):vt.fill(n,A)),be("click",$,ft=>{if(ut._lock)return;jt(ft);let bt=b.indexOf(w);if((ft.ctrlKey||ft.metaKey)!=dt.isolate){let Nt=b.some((Ut,Ot)=>Ot>0&&Ot!=bt&&Ut.show);b.forEach((Ut,Ot)=>{Ot>0&&qi(Ot,Nt?Ot==bt?We:mn:We,!0,xn.setSeries)})}else qi(bt,{show:!w.show},!0,xn.setSeries)},!1),Qt&&be(_m,$,ft=>{ut._lock||(jt(ft),qi(b.indexOf(w),Yr,!0,xn.setSeries))},!1));for(var at in de){let ft=Di("td",yx,U);ft.textContent="--",I.push(ft)}return[U,I]}let Dn=new Map;function be(w,A,I,U=!0){let $=Dn.get(A)||{},J=ut.bind[w](n,A,I,U);J&&(yr(w,A,$[w]=J),Dn.set(A,$))}function Mn(w,A,I){let U=Dn.get(A)||{};for(let $ in U)(w==null||$==w)&&(ju($,A,U[$]),delete U[$]);w==null&&Dn.delete(A)}let on=0,gn=0,k=0,Pt=0,Kt=0,oe=0,Mt=Kt,Be=oe,Ht=k,qt=Pt,P=0,M=0,X=0,ht=0;n.bbox={};let ot=!1,yt=!1,xt=!1,nt=!1,st=!1,mt=!1;function O(w,A,I){(I||w!=n.width||A!=n.height)&&rt(w,A),ce(!1),xt=!0,yt=!0,Xn()}function rt(w,A){n.width=on=k=w,n.height=gn=Pt=A,Kt=oe=0,wt(),Wt();let I=n.bbox;P=I.left=mr(Kt*Ae,.5),M=I.top=mr(oe*Ae,.5),X=I.width=mr(k*Ae,.5),ht=I.height=mr(Pt*Ae,.5)}let it=3;function Et(){let w=!1,A=0;for(;!w;){A++;let I=Gr(A),U=Xi(A);w=A==it||I&&U,w||(rt(n.width,n.height),yt=!0)}}function _t({width:w,height:A}){O(w,A)}n.setSize=_t;function wt(){let w=!1,A=!1,I=!1,U=!1;S.forEach(($,J)=>{if($.show&&$._show){let{side:at,_size:ft}=$,bt=at%2,Nt=$.label!=null?$.labelSize:0,Ut=ft+Nt;Ut>0&&(bt?(k-=Ut,at==3?(Kt+=Ut,U=!0):I=!0):(Pt-=Ut,at==0?(oe+=Ut,w=!0):A=!0))}}),Wi[0]=w,Wi[1]=I,Wi[2]=A,Wi[3]=U,k-=Pi[1]+Pi[3],Kt+=Pi[3],Pt-=Pi[2]+Pi[0],oe+=Pi[0]}function Wt(){let w=Kt+k,A=oe+Pt,I=Kt,U=oe;function $(J,at){switch(J){case 1:return w+=at,w-at;case 2:return A+=at,A-at;case 3:return I-=at,I+at;case 0:return U-=at,U+at}}S.forEach((J,at)=>{if(J.show&&J._show){let ft=J.side;J._pos=$(ft,J._size),J.label!=null&&(J._lpos=$(ft,J.labelSize))}})}if(ut.dataIdx==null){let w=ut.hover,A=w.skip=new Set(w.skip??[]);A.add(void 0);let I=w.prox=ve(w.prox),U=w.bias??=0;ut.dataIdx=($,J,at,ft)=>{if(J==0)return at;let bt=at,Nt=I($,J,at,ft)??He,Ut=Nt>=0&&Nt<He,Ot=D.ori==0?k:Pt,se=ut.left,Te=t[0],Se=t[J];if(A.has(Se[at])){bt=null;let _e=null,Jt=null,Xt;if(U==0||U==-1)for(Xt=at;_e==null&&Xt-- >0;)A.has(Se[Xt])||(_e=Xt);if(U==0||U==1)for(Xt=at;Jt==null&&Xt++<Se.length;)A.has(Se[Xt])||(Jt=Xt);if(_e!=null||Jt!=null)if(Ut){let Ye=_e==null?-1/0:G(Te[_e],D,Ot,0),cn=Jt==null?1/0:G(Te[Jt],D,Ot,0),On=se-Ye,ke=cn-se;On<=ke?On<=Nt&&(bt=_e):ke<=Nt&&(bt=Jt)}else bt=Jt==null?_e:_e==null?Jt:at-_e<=Jt-at?_e:Jt}else Ut&&An(se-G(Te[at],D,Ot,0))>Nt&&(bt=null);return bt}}let jt=w=>{ut.event=w};ut.idxs=et,ut._lock=!1;let ct=ut.points;ct.show=ve(ct.show),ct.size=ve(ct.size),ct.stroke=ve(ct.stroke),ct.width=ve(ct.width),ct.fill=ve(ct.fill);let kt=n.focus=bn({},i.focus||{alpha:.3},ut.focus),Qt=kt.prox>=0,Ct=Qt&&ct.one,ae=[],$e=[],Qn=[];function Yo(w,A){let I=ct.show(n,A);if(I instanceof HTMLElement)return mi(I,dx),mi(I,w.class),Ji(I,-10,-10,k,Pt),m.insertBefore(I,ae[A]),I}function Br(w,A){if(s==1||A>0){let I=s==1&&y[w.scale].time,U=w.value;w.value=I?Lm(U)?Bm(q,km(U,V)):U||j:U||Tb,w.label=w.label||(I?yb:_b)}if(Ct||A>0){w.width=w.width==null?1:w.width,w.paths=w.paths||zb||Px,w.fillTo=ve(w.fillTo||Ib),w.pxAlign=+Me(w.pxAlign,x),w.pxRound=Ym(w.pxAlign),w.stroke=ve(w.stroke||null),w.fill=ve(w.fill||null),w._stroke=w._fill=w._paths=w._focus=null;let I=Ab(ri(1,w.width),1),U=w.points=bn({},{size:I,width:ri(1,I*.2),stroke:w.stroke,space:I*2,paths:Hb,_stroke:null,_fill:null},w.points);U.show=ve(U.show),U.filter=ve(U.filter),U.fill=ve(U.fill),U.stroke=ve(U.stroke),U.paths=ve(U.paths),U.pxAlign=w.pxAlign}if(tt){let I=Oe(w,A);re.splice(A,0,I[0]),Gt.splice(A,0,I[1]),dt.values.push(null)}if(gt){et.splice(A,0,null);let I=null;Ct?A==0&&(I=Yo(w,A)):A>0&&(I=Yo(w,A)),ae.splice(A,0,I),$e.splice(A,0,0),Qn.splice(A,0,0)}Fn("addSeries",A)}function Cu(w,A){A=A??b.length,w=s==1?sd(w,A,Hm,Xm):sd(w,A,{},$m),b.splice(A,0,w),Br(b[A],A)}n.addSeries=Cu;function fl(w){if(b.splice(w,1),tt){dt.values.splice(w,1),Gt.splice(w,1);let A=re.splice(w,1)[0];Mn(null,A.firstChild),A.remove()}gt&&(et.splice(w,1),ae.splice(w,1)[0].remove(),$e.splice(w,1),Qn.splice(w,1)),Fn("delSeries",w)}n.delSeries=fl;let Wi=[!1,!1,!1,!1];function rs(w,A){if(w._show=w.show,w.show){let I=w.side%2,U=y[w.scale];U==null&&(w.scale=I?b[1].scale:E,U=y[w.scale]);let $=U.time;w.size=ve(w.size),w.space=ve(w.space),w.rotate=ve(w.rotate),ks(w.incrs)&&w.incrs.forEach(at=>{!Bs.has(at)&&Bs.set(at,ag(at))}),w.incrs=ve(w.incrs||(U.distr==2?jx:$?_==1?tb:ib:gr)),w.splits=ve(w.splits||($&&U.distr==1?lt:U.distr==3?td:U.distr==4?bb:xb)),w.stroke=ve(w.stroke),w.grid.stroke=ve(w.grid.stroke),w.ticks.stroke=ve(w.ticks.stroke),w.border.stroke=ve(w.border.stroke);let J=w.values;w.values=ks(J)&&!ks(J[0])?ve(J):$?ks(J)?Om(q,Fm(J,V)):Lm(J)?ob(q,J):J||Z:J||vb,w.filter=ve(w.filter||(U.distr>=3&&U.log==10?Mb:U.distr==3&&U.log==2?Eb:rg)),w.font=jm(w.font),w.labelFont=jm(w.labelFont),w._size=w.size(n,null,A,0),w._space=w._rotate=w._incrs=w._found=w._splits=w._values=null,w._size>0&&(Wi[A]=!0,w._el=Mi(lx,u))}}function os(w,A,I,U){let[$,J,at,ft]=I,bt=A%2,Nt=0;return bt==0&&(ft||J)&&(Nt=A==0&&!$||A==2&&!at?Tn(zm.size/3):0),bt==1&&($||at)&&(Nt=A==1&&!J||A==3&&!ft?Tn(Vm.size/2):0),Nt}let Zo=n.padding=(i.padding||[os,os,os,os]).map(w=>ve(Me(w,os))),Pi=n._padding=Zo.map((w,A)=>w(n,A,Wi,0)),an,fn=null,pn=null,$i=s==1?b[0].idxs:null,ui=null,Ps=!1;function Ko(w,A){if(t=w??[],n.data=n._data=t,s==2){an=0;for(let I=1;I<b.length;I++)an+=t[I][0].length}else{t.length==0&&(n.data=n._data=t=[[]]),ui=t[0],an=ui.length;let I=t;if(B==2){I=t.slice();let U=I[0]=Array(an);for(let $=0;$<an;$++)U[$]=$}n._data=t=I}if(ce(!0),Fn("setData"),B==2&&(xt=!0),A!==!1){let I=D;I.auto(n,Ps)?Jo():Ds(E,I.min,I.max),nt=nt||ut.left>=0,mt=!0,Xn()}}n.setData=Ko;function Jo(){Ps=!0;let w,A;s==1&&(an>0?(fn=$i[0]=0,pn=$i[1]=an-1,w=t[0][fn],A=t[0][pn],B==2?(w=fn,A=pn):w==A&&(B==3?[w,A]=Ul(w,w,D.log,!1):B==4?[w,A]=ld(w,w,D.log,!1):D.time?A=w+Tn(86400/_):[w,A]=Ll(w,A,cd,!0))):(fn=$i[0]=w=null,pn=$i[1]=A=null)),Ds(E,w,A)}let zr,Is,Hr,R,z,Q,Y,K,Tt,It;function At(w,A,I,U,$,J){w??=mm,I??=ud,U??="butt",$??=mm,J??="round",w!=zr&&(d.strokeStyle=zr=w),$!=Is&&(d.fillStyle=Is=$),A!=Hr&&(d.lineWidth=Hr=A),J!=z&&(d.lineJoin=z=J),U!=Q&&(d.lineCap=Q=U),I!=R&&d.setLineDash(R=I)}function Lt(w,A,I,U){A!=Is&&(d.fillStyle=Is=A),w!=Y&&(d.font=Y=w),I!=K&&(d.textAlign=K=I),U!=Tt&&(d.textBaseline=Tt=U)}function zt(w,A,I,U,$=0){if(U.length>0&&w.auto(n,Ps)&&(A==null||A.min==null)){let J=Me(fn,0),at=Me(pn,U.length-1),ft=I.min==null?Mx(U,J,at,$,w.distr==3):[I.min,I.max];w.min=Ui(w.min,I.min=ft[0]),w.max=ri(w.max,I.max=ft[1])}}let ee={min:null,max:null};function fe(){for(let U in y){let $=y[U];W[U]==null&&($.min==null||W[E]!=null&&$.auto(n,Ps))&&(W[U]=ee)}for(let U in y){let $=y[U];W[U]==null&&$.from!=null&&W[$.from]!=null&&(W[U]=ee)}W[E]!=null&&ce(!0);let w={};for(let U in W){let $=W[U];if($!=null){let J=w[U]=eo(y[U],Dx);if($.min!=null)bn(J,$);else if(U!=E||s==2)if(an==0&&J.from==null){let at=J.range(n,null,null,U);J.min=at[0],J.max=at[1]}else J.min=He,J.max=-He}}if(an>0){b.forEach((U,$)=>{if(s==1){let J=U.scale,at=W[J];if(at==null)return;let ft=w[J];if($==0){let bt=ft.range(n,ft.min,ft.max,J);ft.min=bt[0],ft.max=bt[1],fn=Ni(ft.min,t[0]),pn=Ni(ft.max,t[0]),pn-fn>1&&(t[0][fn]<ft.min&&fn++,t[0][pn]>ft.max&&pn--),U.min=ui[fn],U.max=ui[pn]}else U.show&&U.auto&&zt(ft,at,U,t[$],U.sorted);U.idxs[0]=fn,U.idxs[1]=pn}else if($>0&&U.show&&U.auto){let[J,at]=U.facets,ft=J.scale,bt=at.scale,[Nt,Ut]=t[$],Ot=w[ft],se=w[bt];Ot!=null&&zt(Ot,W[ft],J,Nt,J.sorted),se!=null&&zt(se,W[bt],at,Ut,at.sorted),U.min=at.min,U.max=at.max}});for(let U in w){let $=w[U],J=W[U];if($.from==null&&(J==null||J.min==null)){let at=$.range(n,$.min==He?null:$.min,$.max==-He?null:$.max,U);$.min=at[0],$.max=at[1]}}}for(let U in w){let $=w[U];if($.from!=null){let J=w[$.from];if(J.min==null)$.min=$.max=null;else{let at=$.range(n,J.min,J.max,U);$.min=at[0],$.max=at[1]}}}let A={},I=!1;for(let U in w){let $=w[U],J=y[U];if(J.min!=$.min||J.max!=$.max){J.min=$.min,J.max=$.max;let at=J.distr;J._min=at==3?us(J.min):at==4?$u(J.min,J.asinh):at==100?J.fwd(J.min):J.min,J._max=at==3?us(J.max):at==4?$u(J.max,J.asinh):at==100?J.fwd(J.max):J.max,A[U]=I=!0}}if(I){b.forEach((U,$)=>{s==2?$>0&&A.y&&(U._paths=null):A[U.scale]&&(U._paths=null)});for(let U in A)xt=!0,Fn("setScale",U);gt&&ut.left>=0&&(nt=mt=!0)}for(let U in W)W[U]=null}function Bt(w){let A=Qu(fn-1,0,an-1),I=Qu(pn+1,0,an-1);for(;w[A]==null&&A>0;)A--;for(;w[I]==null&&I<an-1;)I++;return[A,I]}function pe(){if(an>0){let w=b.some(A=>A._focus)&&It!=kt.alpha;w&&(d.globalAlpha=It=kt.alpha),b.forEach((A,I)=>{if(I>0&&A.show&&(tn(I,!1),tn(I,!0),A._paths==null)){let U=It;It!=A.alpha&&(d.globalAlpha=It=A.alpha);let $=s==2?[0,t[I][0].length-1]:Bt(t[I]);A._paths=A.paths(n,I,$[0],$[1]),It!=U&&(d.globalAlpha=It=U)}}),b.forEach((A,I)=>{if(I>0&&A.show){let U=It;It!=A.alpha&&(d.globalAlpha=It=A.alpha),A._paths!=null&&Le(I,!1);{let $=A._paths!=null?A._paths.gaps:null,J=A.points.show(n,I,fn,pn,$),at=A.points.filter(n,I,J,$);(J||at)&&(A.points._paths=A.points.paths(n,I,fn,pn,at),Le(I,!0))}It!=U&&(d.globalAlpha=It=U),Fn("drawSeries",I)}}),w&&(d.globalAlpha=It=1)}}function tn(w,A){let I=A?b[w].points:b[w];I._stroke=I.stroke(n,w),I._fill=I.fill(n,w)}function Le(w,A){let I=A?b[w].points:b[w],{stroke:U,fill:$,clip:J,flags:at,_stroke:ft=I._stroke,_fill:bt=I._fill,_width:Nt=I.width}=I._paths;Nt=Ge(Nt*Ae,3);let Ut=null,Ot=Nt%2/2;A&&bt==null&&(bt=Nt>0?"#fff":ft);let se=I.pxAlign==1&&Ot>0;if(se&&d.translate(Ot,Ot),!A){let Te=P-Nt/2,Se=M-Nt/2,_e=X+Nt,Jt=ht+Nt;Ut=new Path2D,Ut.rect(Te,Se,_e,Jt)}A?Ft(ft,Nt,I.dash,I.cap,bt,U,$,at,J):De(w,ft,Nt,I.dash,I.cap,bt,U,$,at,Ut,J),se&&d.translate(-Ot,-Ot)}function De(w,A,I,U,$,J,at,ft,bt,Nt,Ut){let Ot=!1;bt!=0&&C.forEach((se,Te)=>{if(se.series[0]==w){let Se=b[se.series[1]],_e=t[se.series[1]],Jt=(Se._paths||aa).band;ks(Jt)&&(Jt=se.dir==1?Jt[0]:Jt[1]);let Xt,Ye=null;Se.show&&Jt&&Tx(_e,fn,pn)?(Ye=se.fill(n,Te)||J,Xt=Se._paths.clip):Jt=null,Ft(A,I,U,$,Ye,at,ft,bt,Nt,Ut,Xt,Jt),Ot=!0}}),Ot||Ft(A,I,U,$,J,at,ft,bt,Nt,Ut)}let En=no|nd;function Ft(w,A,I,U,$,J,at,ft,bt,Nt,Ut,Ot){At(w,A,I,U,$),(bt||Nt||Ot)&&(d.save(),bt&&d.clip(bt),Nt&&d.clip(Nt)),Ot?(ft&En)==En?(d.clip(Ot),Ut&&d.clip(Ut),ye($,at),_n(w,J,A)):ft&nd?(ye($,at),d.clip(Ot),_n(w,J,A)):ft&no&&(d.save(),d.clip(Ot),Ut&&d.clip(Ut),ye($,at),d.restore(),_n(w,J,A)):(ye($,at),_n(w,J,A)),(bt||Nt||Ot)&&d.restore()}function _n(w,A,I){I>0&&(A instanceof Map?A.forEach((U,$)=>{d.strokeStyle=zr=$,d.stroke(U)}):A!=null&&w&&d.stroke(A))}function ye(w,A){A instanceof Map?A.forEach((I,U)=>{d.fillStyle=Is=U,d.fill(I)}):A!=null&&w&&d.fill(A)}function as(w,A,I,U){let $=S[w],J;if(U<=0)J=[0,0];else{let at=$._space=$.space(n,w,A,I,U),ft=$._incrs=$.incrs(n,w,A,I,U,at);J=qb(A,I,ft,U,at)}return $._found=J}function yn(w,A,I,U,$,J,at,ft,bt,Nt){let Ut=at%2/2;x==1&&d.translate(Ut,Ut),At(ft,at,bt,Nt,ft),d.beginPath();let Ot,se,Te,Se,_e=$+(U==0||U==3?-J:J);I==0?(se=$,Se=_e):(Ot=$,Te=_e);for(let Jt=0;Jt<w.length;Jt++)A[Jt]!=null&&(I==0?Ot=Te=w[Jt]:se=Se=w[Jt],d.moveTo(Ot,se),d.lineTo(Te,Se));d.stroke(),x==1&&d.translate(-Ut,-Ut)}function Gr(w){let A=!0;return S.forEach((I,U)=>{if(!I.show)return;let $=y[I.scale];if($.min==null){I._show&&(A=!1,I._show=!1,ce(!1));return}else I._show||(A=!1,I._show=!0,ce(!1));let J=I.side,at=J%2,{min:ft,max:bt}=$,[Nt,Ut]=as(U,ft,bt,at==0?k:Pt);if(Ut==0)return;let Ot=$.distr==2,se=I._splits=I.splits(n,U,ft,bt,Nt,Ut,Ot),Te=$.distr==2?se.map(Xt=>ui[Xt]):se,Se=$.distr==2?ui[se[1]]-ui[se[0]]:Nt,_e=I._values=I.values(n,I.filter(n,Te,U,Ut,Se),U,Ut,Se);I._rotate=J==2?I.rotate(n,_e,U,Ut):0;let Jt=I._size;I._size=Ei(I.size(n,_e,U,w)),Jt!=null&&I._size!=Jt&&(A=!1)}),A}function Xi(w){let A=!0;return Zo.forEach((I,U)=>{let $=I(n,U,Wi,w);$!=Pi[U]&&(A=!1),Pi[U]=$}),A}function ls(){for(let w=0;w<S.length;w++){let A=S[w];if(!A.show||!A._show)continue;let I=A.side,U=I%2,$,J,at=A.stroke(n,w),ft=I==0||I==3?-1:1,[bt,Nt]=A._found;if(A.label!=null){let ni=A.labelGap*ft,pi=Tn((A._lpos+ni)*Ae);Lt(A.labelFont[0],at,"center",I==2?"top":pm),d.save(),U==1?($=J=0,d.translate(pi,Tn(M+ht/2)),d.rotate((I==3?-Pl:Pl)/2)):($=Tn(P+X/2),J=pi);let pr=ig(A.label)?A.label(n,w,bt,Nt):A.label;d.fillText(pr,$,J),d.restore()}if(Nt==0)continue;let Ut=y[A.scale],Ot=U==0?X:ht,se=U==0?P:M,Te=A._splits,Se=Ut.distr==2?Te.map(ni=>ui[ni]):Te,_e=Ut.distr==2?ui[Te[1]]-ui[Te[0]]:bt,Jt=A.ticks,Xt=A.border,Ye=Jt.show?Jt.size:0,cn=Tn(Ye*Ae),On=Tn((A.alignTo==2?A._size-Ye-A.gap:A.gap)*Ae),ke=A._rotate*-Pl/180,hn=g(A._pos*Ae),di=(cn+On)*ft,ei=hn+di;J=U==0?ei:0,$=U==1?ei:0;let wi=A.font[0],Ii=A.align==1?Kr:A.align==2?Gu:ke>0?Kr:ke<0?Gu:U==0?"center":I==3?Gu:Kr,Zi=ke||U==1?"middle":I==2?"top":pm;Lt(wi,at,Ii,Zi);let fi=A.font[1]*A.lineGap,Si=Te.map(ni=>g(a(ni,Ut,Ot,se))),Li=A._values;for(let ni=0;ni<Li.length;ni++){let pi=Li[ni];if(pi!=null){U==0?$=Si[ni]:J=Si[ni],pi=""+pi;let pr=pi.indexOf(`
`)==-1?[pi]:pi.split(/\n/gm);for(let ii=0;ii<pr.length;ii++){let Wp=pr[ii];ke?(d.save(),d.translate($,J+ii*fi),d.rotate(ke),d.fillText(Wp,0,0),d.restore()):d.fillText(Wp,$,J+ii*fi)}}}Jt.show&&yn(Si,Jt.filter(n,Se,w,Nt,_e),U,I,hn,cn,Ge(Jt.width*Ae,3),Jt.stroke(n,w),Jt.dash,Jt.cap);let Ki=A.grid;Ki.show&&yn(Si,Ki.filter(n,Se,w,Nt,_e),U,U==0?2:1,U==0?M:P,U==0?ht:X,Ge(Ki.width*Ae,3),Ki.stroke(n,w),Ki.dash,Ki.cap),Xt.show&&yn([hn],[1],U==0?1:0,U==0?1:2,U==1?M:P,U==1?ht:X,Ge(Xt.width*Ae,3),Xt.stroke(n,w),Xt.dash,Xt.cap)}Fn("drawAxes")}function ce(w){b.forEach((A,I)=>{I>0&&(A._paths=null,w&&(s==1?(A.min=null,A.max=null):A.facets.forEach(U=>{U.min=null,U.max=null})))})}let ln=!1,ti=!1,Ne=[];function vn(){ti=!1;for(let w=0;w<Ne.length;w++)Fn(...Ne[w]);Ne.length=0}function Xn(){ln||(zx(Tp),ln=!0)}function pl(w,A=!1){ln=!0,ti=A,w(n),Tp(),A&&Ne.length>0&&queueMicrotask(vn)}n.batch=pl;function Tp(){if(ot&&(fe(),ot=!1),xt&&(Et(),xt=!1),yt){if(Ze(p,Kr,Kt),Ze(p,"top",oe),Ze(p,ia,k),Ze(p,sa,Pt),Ze(m,Kr,Kt),Ze(m,"top",oe),Ze(m,ia,k),Ze(m,sa,Pt),Ze(u,ia,on),Ze(u,sa,gn),h.width=Tn(on*Ae),h.height=Tn(gn*Ae),S.forEach(({_el:w,_show:A,_size:I,_pos:U,side:$})=>{if(w!=null)if(A){let J=$===3||$===0?I:0,at=$%2==1;Ze(w,at?"left":"top",U-J),Ze(w,at?"width":"height",I),Ze(w,at?"top":"left",at?oe:Kt),Ze(w,at?"height":"width",at?Pt:k),Ju(w,_r)}else mi(w,_r)}),zr=Is=Hr=z=Q=Y=K=Tt=R=null,It=1,ta(!0),Kt!=Mt||oe!=Be||k!=Ht||Pt!=qt){ce(!1);let w=k/Ht,A=Pt/qt;if(gt&&!nt&&ut.left>=0){ut.left*=w,ut.top*=A,Vr&&Ji(Vr,Tn(ut.left),0,k,Pt),Wr&&Ji(Wr,0,Tn(ut.top),k,Pt);for(let I=0;I<ae.length;I++){let U=ae[I];U!=null&&($e[I]*=w,Qn[I]*=A,Ji(U,Ei($e[I]),Ei(Qn[I]),k,Pt))}}if(qe.show&&!st&&qe.left>=0&&qe.width>0){qe.left*=w,qe.width*=w,qe.top*=A,qe.height*=A;for(let I in Uu)Ze(qr,I,qe[I])}Mt=Kt,Be=oe,Ht=k,qt=Pt}Fn("setSize"),yt=!1}on>0&&gn>0&&(d.clearRect(0,0,h.width,h.height),Fn("drawClear"),T.forEach(w=>w()),Fn("draw")),qe.show&&st&&(ml(qe),st=!1),gt&&nt&&(fr(null,!0,!1),nt=!1),dt.show&&dt.live&&mt&&(Du(),mt=!1),l||(l=!0,n.status=1,Fn("ready")),Ps=!1,ln=!1}n.redraw=(w,A)=>{xt=A||!1,w!==!1?Ds(E,D.min,D.max):Xn()};function Pu(w,A){let I=y[w];if(I.from==null){if(an==0){let U=I.range(n,A.min,A.max,w);A.min=U[0],A.max=U[1]}if(A.min>A.max){let U=A.min;A.min=A.max,A.max=U}if(an>1&&A.min!=null&&A.max!=null&&A.max-A.min<1e-16)return;w==E&&I.distr==2&&an>0&&(A.min=Ni(A.min,t[0]),A.max=Ni(A.max,t[0]),A.min==A.max&&A.max++),W[w]=A,ot=!0,Xn()}}n.setScale=Pu;let Iu,Lu,Vr,Wr,Ap,Rp,$r,Xr,Cp,Pp,Xe,je,Ls=!1,zn=ut.drag,Nn=zn.x,Un=zn.y;gt&&(ut.x&&(Iu=Mi(hx,m)),ut.y&&(Lu=Mi(ux,m)),D.ori==0?(Vr=Iu,Wr=Lu):(Vr=Lu,Wr=Iu),Xe=ut.left,je=ut.top);let qe=n.select=bn({show:!0,over:!0,left:0,width:0,top:0,height:0},i.select),qr=qe.show?Mi(cx,qe.over?m:p):null;function ml(w,A){if(qe.show){for(let I in w)qe[I]=w[I],I in Uu&&Ze(qr,I,w[I]);A!==!1&&Fn("setSelect")}}n.setSelect=ml;function Nv(w){if(b[w].show)tt&&Ju(re[w],_r);else if(tt&&mi(re[w],_r),gt){let I=Ct?ae[0]:ae[w];I!=null&&Ji(I,-10,-10,k,Pt)}}function Ds(w,A,I){Pu(w,{min:A,max:I})}function qi(w,A,I,U){A.focus!=null&&Bv(w),A.show!=null&&b.forEach(($,J)=>{J>0&&(w==J||w==null)&&($.show=A.show,Nv(J),s==2?(Ds($.facets[0].scale,null,null),Ds($.facets[1].scale,null,null)):Ds($.scale,null,null),Xn())}),I!==!1&&Fn("setSeries",w,A),U&&ea("setSeries",n,w,A)}n.setSeries=qi;function Uv(w,A){bn(C[w],A)}function Fv(w,A){w.fill=ve(w.fill||null),w.dir=Me(w.dir,-1),A=A??C.length,C.splice(A,0,w)}function Ov(w){w==null?C.length=0:C.splice(w,1)}n.addBand=Fv,n.setBand=Uv,n.delBand=Ov;function kv(w,A){b[w].alpha=A,gt&&ae[w]!=null&&(ae[w].style.opacity=A),tt&&re[w]&&(re[w].style.opacity=A)}let cs,Ns,dr,Yr={focus:!0};function Bv(w){if(w!=dr){let A=w==null,I=kt.alpha!=1;b.forEach((U,$)=>{if(s==1||$>0){let J=A||$==0||$==w;U._focus=A?null:J,I&&kv($,J?1:kt.alpha)}}),dr=w,I&&Xn()}}tt&&Qt&&be(ym,Rt,w=>{ut._lock||(jt(w),dr!=null&&qi(null,Yr,!0,xn.setSeries))});function Yi(w,A,I){let U=y[A];I&&(w=w/Ae-(U.ori==1?oe:Kt));let $=k;U.ori==1&&($=Pt,w=$-w),U.dir==-1&&(w=$-w);let J=U._min,at=U._max,ft=w/$,bt=J+(at-J)*ft,Nt=U.distr;return Nt==3?Qr(10,bt):Nt==4?Rx(bt,U.asinh):Nt==100?U.bwd(bt):bt}function zv(w,A){let I=Yi(w,E,A);return Ni(I,t[0],fn,pn)}n.valToIdx=w=>Ni(w,t[0]),n.posToIdx=zv,n.posToVal=Yi,n.valToPos=(w,A,I)=>y[A].ori==0?r(w,y[A],I?X:k,I?P:0):o(w,y[A],I?ht:Pt,I?M:0),n.setCursor=(w,A,I)=>{Xe=w.left,je=w.top,fr(null,A,I)};function Ip(w,A){Ze(qr,Kr,qe.left=w),Ze(qr,ia,qe.width=A)}function Lp(w,A){Ze(qr,"top",qe.top=w),Ze(qr,sa,qe.height=A)}let jo=D.ori==0?Ip:Lp,Qo=D.ori==1?Ip:Lp;function Hv(){if(tt&&dt.live)for(let w=s==2?1:0;w<b.length;w++){if(w==0&&le)continue;let A=dt.values[w],I=0;for(let U in A)Gt[w][I++].firstChild.nodeValue=A[U]}}function Du(w,A){if(w!=null&&(w.idxs?w.idxs.forEach((I,U)=>{et[U]=I}):Lx(w.idx)||et.fill(w.idx),dt.idx=et[0]),tt&&dt.live){for(let I=0;I<b.length;I++)(I>0||s==1&&!le)&&Gv(I,et[I]);Hv()}mt=!1,A!==!1&&Fn("setLegend")}n.setLegend=Du;function Gv(w,A){let I=b[w],U=w==0&&B==2?ui:t[w],$;le?$=I.values(n,w,A)??ie:($=I.value(n,A==null?null:U[A],w,A),$=$==null?ie:{_:$}),dt.values[w]=$}function fr(w,A,I){Cp=Xe,Pp=je,[Xe,je]=ut.move(n,Xe,je),ut.left=Xe,ut.top=je,gt&&(Vr&&Ji(Vr,Tn(Xe),0,k,Pt),Wr&&Ji(Wr,0,Tn(je),k,Pt));let U,$=fn>pn;cs=He,Ns=null;let J=D.ori==0?k:Pt,at=D.ori==1?k:Pt;if(Xe<0||an==0||$){U=ut.idx=null;for(let ft=0;ft<b.length;ft++){let bt=ae[ft];bt!=null&&Ji(bt,-10,-10,k,Pt)}Qt&&qi(null,Yr,!0,w==null&&xn.setSeries),dt.live&&(et.fill(U),mt=!0)}else{let ft,bt,Nt;s==1&&(ft=D.ori==0?Xe:je,bt=Yi(ft,E),U=ut.idx=Ni(bt,t[0],fn,pn),Nt=G(t[0][U],D,J,0));let Ut=-10,Ot=-10,se=0,Te=0,Se=!0,_e="",Jt="";for(let Xt=s==2?1:0;Xt<b.length;Xt++){let Ye=b[Xt],cn=et[Xt],On=cn==null?null:s==1?t[Xt][cn]:t[Xt][1][cn],ke=ut.dataIdx(n,Xt,U,bt),hn=ke==null?null:s==1?t[Xt][ke]:t[Xt][1][ke];if(mt=mt||hn!=On||ke!=cn,et[Xt]=ke,Xt>0&&Ye.show){let di=ke==null?-10:ke==U?Nt:G(s==1?t[0][ke]:t[Xt][0][ke],D,J,0),ei=hn==null?-10:N(hn,s==1?y[Ye.scale]:y[Ye.facets[1].scale],at,0);if(Qt&&hn!=null){let wi=D.ori==1?Xe:je,Ii=An(kt.dist(n,Xt,ke,ei,wi));if(Ii<cs){let Zi=kt.bias;if(Zi!=0){let fi=Yi(wi,Ye.scale),Si=hn>=0?1:-1,Li=fi>=0?1:-1;Li==Si&&(Li==1?Zi==1?hn>=fi:hn<=fi:Zi==1?hn<=fi:hn>=fi)&&(cs=Ii,Ns=Xt)}else cs=Ii,Ns=Xt}}if(mt||Ct){let wi,Ii;D.ori==0?(wi=di,Ii=ei):(wi=ei,Ii=di);let Zi,fi,Si,Li,Ki,ni,pi=!0,pr=ct.bbox;if(pr!=null){pi=!1;let ii=pr(n,Xt);Si=ii.left,Li=ii.top,Zi=ii.width,fi=ii.height}else Si=wi,Li=Ii,Zi=fi=ct.size(n,Xt);if(ni=ct.fill(n,Xt),Ki=ct.stroke(n,Xt),Ct)Xt==Ns&&cs<=kt.prox&&(Ut=Si,Ot=Li,se=Zi,Te=fi,Se=pi,_e=ni,Jt=Ki);else{let ii=ae[Xt];ii!=null&&($e[Xt]=Si,Qn[Xt]=Li,Em(ii,Zi,fi,pi),Sm(ii,ni,Ki),Ji(ii,Ei(Si),Ei(Li),k,Pt))}}}}if(Ct){let Xt=kt.prox,Ye=dr==null?cs<=Xt:cs>Xt||Ns!=dr;if(mt||Ye){let cn=ae[0];cn!=null&&($e[0]=Ut,Qn[0]=Ot,Em(cn,se,Te,Se),Sm(cn,_e,Jt),Ji(cn,Ei(Ut),Ei(Ot),k,Pt))}}}if(qe.show&&Ls)if(w!=null){let[ft,bt]=xn.scales,[Nt,Ut]=xn.match,[Ot,se]=w.cursor.sync.scales,Te=w.cursor.drag;if(Nn=Te._x,Un=Te._y,Nn||Un){let{left:Se,top:_e,width:Jt,height:Xt}=w.select,Ye=w.scales[Ot].ori,cn=w.posToVal,On,ke,hn,di,ei,wi=ft!=null&&Nt(ft,Ot),Ii=bt!=null&&Ut(bt,se);wi&&Nn?(Ye==0?(On=Se,ke=Jt):(On=_e,ke=Xt),hn=y[ft],di=G(cn(On,Ot),hn,J,0),ei=G(cn(On+ke,Ot),hn,J,0),jo(Ui(di,ei),An(ei-di))):jo(0,J),Ii&&Un?(Ye==1?(On=Se,ke=Jt):(On=_e,ke=Xt),hn=y[bt],di=N(cn(On,se),hn,at,0),ei=N(cn(On+ke,se),hn,at,0),Qo(Ui(di,ei),An(ei-di))):Qo(0,at)}else Fu()}else{let ft=An(Cp-Ap),bt=An(Pp-Rp);if(D.ori==1){let se=ft;ft=bt,bt=se}Nn=zn.x&&ft>=zn.dist,Un=zn.y&&bt>=zn.dist;let Nt=zn.uni;Nt!=null?Nn&&Un&&(Nn=ft>=Nt,Un=bt>=Nt,!Nn&&!Un&&(bt>ft?Un=!0:Nn=!0)):zn.x&&zn.y&&(Nn||Un)&&(Nn=Un=!0);let Ut,Ot;Nn&&(D.ori==0?(Ut=$r,Ot=Xe):(Ut=Xr,Ot=je),jo(Ui(Ut,Ot),An(Ot-Ut)),Un||Qo(0,at)),Un&&(D.ori==1?(Ut=$r,Ot=Xe):(Ut=Xr,Ot=je),Qo(Ui(Ut,Ot),An(Ot-Ut)),Nn||jo(0,J)),!Nn&&!Un&&(jo(0,0),Qo(0,0))}if(zn._x=Nn,zn._y=Un,w==null){if(I){if(Vp!=null){let[ft,bt]=xn.scales;xn.values[0]=ft!=null?Yi(D.ori==0?Xe:je,ft):null,xn.values[1]=bt!=null?Yi(D.ori==1?Xe:je,bt):null}ea(Vu,n,Xe,je,k,Pt,U)}if(Qt){let ft=I&&xn.setSeries,bt=kt.prox;dr==null?cs<=bt&&qi(Ns,Yr,!0,ft):cs>bt?qi(null,Yr,!0,ft):Ns!=dr&&qi(Ns,Yr,!0,ft)}}mt&&(dt.idx=U,Du()),A!==!1&&Fn("setCursor")}let Us=null;Object.defineProperty(n,"rect",{get(){return Us==null&&ta(!1),Us}});function ta(w=!1){w?Us=null:(Us=m.getBoundingClientRect(),Fn("syncRect",Us))}function Dp(w,A,I,U,$,J,at){ut._lock||Ls&&w!=null&&w.movementX==0&&w.movementY==0||(Nu(w,A,I,U,$,J,at,!1,w!=null),w!=null?fr(null,!0,!0):fr(A,!0,!1))}function Nu(w,A,I,U,$,J,at,ft,bt){if(Us==null&&ta(!1),jt(w),w!=null)I=w.clientX-Us.left,U=w.clientY-Us.top;else{if(I<0||U<0){Xe=-10,je=-10;return}let[Nt,Ut]=xn.scales,Ot=A.cursor.sync,[se,Te]=Ot.values,[Se,_e]=Ot.scales,[Jt,Xt]=xn.match,Ye=A.axes[0].side%2==1,cn=D.ori==0?k:Pt,On=D.ori==1?k:Pt,ke=Ye?J:$,hn=Ye?$:J,di=Ye?U:I,ei=Ye?I:U;if(Se!=null?I=Jt(Nt,Se)?a(se,y[Nt],cn,0):-10:I=cn*(di/ke),_e!=null?U=Xt(Ut,_e)?a(Te,y[Ut],On,0):-10:U=On*(ei/hn),D.ori==1){let wi=I;I=U,U=wi}}bt&&(A==null||A.cursor.event.type==Vu)&&((I<=1||I>=k-1)&&(I=mr(I,k)),(U<=1||U>=Pt-1)&&(U=mr(U,Pt))),ft?(Ap=I,Rp=U,[$r,Xr]=ut.move(n,I,U)):(Xe=I,je=U)}let Uu={width:0,height:0,left:0,top:0};function Fu(){ml(Uu,!1)}let Np,Up,Fp,Op;function kp(w,A,I,U,$,J,at){Ls=!0,Nn=Un=zn._x=zn._y=!1,Nu(w,A,I,U,$,J,at,!0,!1),w!=null&&(be(Wu,Zu,Bp,!1),ea(gm,n,$r,Xr,k,Pt,null));let{left:ft,top:bt,width:Nt,height:Ut}=qe;Np=ft,Up=bt,Fp=Nt,Op=Ut}function Bp(w,A,I,U,$,J,at){Ls=zn._x=zn._y=!1,Nu(w,A,I,U,$,J,at,!1,!0);let{left:ft,top:bt,width:Nt,height:Ut}=qe,Ot=Nt>0||Ut>0,se=Np!=ft||Up!=bt||Fp!=Nt||Op!=Ut;if(Ot&&se&&ml(qe),zn.setScale&&Ot&&se){let Te=ft,Se=Nt,_e=bt,Jt=Ut;if(D.ori==1&&(Te=bt,Se=Ut,_e=ft,Jt=Nt),Nn&&Ds(E,Yi(Te,E),Yi(Te+Se,E)),Un)for(let Xt in y){let Ye=y[Xt];Xt!=E&&Ye.from==null&&Ye.min!=He&&Ds(Xt,Yi(_e+Jt,Xt),Yi(_e,Xt))}Fu()}else ut.lock&&(ut._lock=!ut._lock,fr(A,!0,w!=null));w!=null&&(Mn(Wu,Zu),ea(Wu,n,Xe,je,k,Pt,null))}function Vv(w,A,I,U,$,J,at){if(ut._lock)return;jt(w);let ft=Ls;if(Ls){let bt=!0,Nt=!0,Ut=10,Ot,se;D.ori==0?(Ot=Nn,se=Un):(Ot=Un,se=Nn),Ot&&se&&(bt=Xe<=Ut||Xe>=k-Ut,Nt=je<=Ut||je>=Pt-Ut),Ot&&bt&&(Xe=Xe<$r?0:k),se&&Nt&&(je=je<Xr?0:Pt),fr(null,!0,!0),Ls=!1}Xe=-10,je=-10,et.fill(null),fr(null,!0,!0),ft&&(Ls=ft)}function zp(w,A,I,U,$,J,at){ut._lock||(jt(w),Jo(),Fu(),w!=null&&ea(vm,n,Xe,je,k,Pt,null))}function Hp(){S.forEach(Yb),O(n.width,n.height,!0)}yr(Il,jr,Hp);let Zr={};Zr.mousedown=kp,Zr.mousemove=Dp,Zr.mouseup=Bp,Zr.dblclick=zp,Zr.setSeries=(w,A,I,U)=>{let $=xn.match[2];I=$(n,A,I),I!=-1&&qi(I,U,!0,!1)},gt&&(be(gm,m,kp),be(Vu,m,Dp),be(_m,m,w=>{jt(w),ta(!1)}),be(ym,m,Vv),be(vm,m,zp),id.add(n),n.syncRect=ta);let gl=n.hooks=i.hooks||{};function Fn(w,A,I){ti?Ne.push([w,A,I]):w in gl&&gl[w].forEach(U=>{U.call(null,n,A,I)})}(i.plugins||[]).forEach(w=>{for(let A in w.hooks)gl[A]=(gl[A]||[]).concat(w.hooks[A])});let Gp=(w,A,I)=>I,xn=bn({key:null,setSeries:!1,filters:{pub:Pm,sub:Pm},scales:[E,b[1]?b[1].scale:null],match:[Im,Im,Gp],values:[null,null]},ut.sync);xn.match.length==2&&xn.match.push(Gp),ut.sync=xn;let Vp=xn.key,Ou=Ag(Vp);function ea(w,A,I,U,$,J,at){xn.filters.pub(w,A,I,U,$,J,at)&&Ou.pub(w,A,I,U,$,J,at)}Ou.sub(n);function Wv(w,A,I,U,$,J,at){xn.filters.sub(w,A,I,U,$,J,at)&&Zr[w](null,A,I,U,$,J,at)}n.pub=Wv;function $v(){Ou.unsub(n),id.delete(n),Dn.clear(),ju(Il,jr,Hp),c.remove(),Rt?.remove(),Fn("destroy")}n.destroy=$v;function ku(){Fn("init",i,t),Ko(t||i.data,!1),W[E]?Pu(E,W[E]):Jo(),st=qe.show&&(qe.width>0||qe.height>0),nt=mt=!0,O(i.width,i.height)}return b.forEach(Br),S.forEach(rs),e?e instanceof HTMLElement?(e.appendChild(c),ku()):e(n,ku):ku(),n}Hn.assign=bn;Hn.fmtNum=hd;Hn.rangeNum=Ll;Hn.rangeLog=Ul;Hn.rangeAsinh=ld;Hn.orient=xr;Hn.pxRatio=Ae;Hn.join=Bx;Hn.fmtDate=dd,Hn.tzDate=Kx;Hn.sync=Ag;{Hn.addGap=Lb,Hn.clipGaps=kl;let i=Hn.paths={points:Dg};i.linear=Ug,i.stepped=Ub,i.bars=Fb,i.spline=kb}function oo({label:i,unit:t}){return t?`${i} [${t}]`:i}function Bg(i){return Array.from(i,t=>Number.isFinite(t)?t:null)}function zg(i,t,e,[n,...s]){let r=n.length-1;if(r<0)return`${i}: no data yet`;let o=e.map((a,l)=>{let c=s[l]?.findLast(h=>Number.isFinite(h));return`${oo(a)} ${c===void 0?"without value":Number(c.toPrecision(4))}`});return`${i}, ${oo(t)} ${Number(n[0].toPrecision(4))} to ${Number(n[r].toPrecision(4))}: ${o.join(", ")}`}var Zb=170;function wn(i){return i?.startsWith("--")?getComputedStyle(document.documentElement).getPropertyValue(i).trim():i}function Gl(i,{title:t,x:e,series:n,height:s=Zb,points:r=!1,legend:o=!0,log:a=!1}){let l=f("div",{role:"img","aria-label":`${t}: no data yet`,class:"plot-canvas"}),c=f("figure",{class:"plot"},f("figcaption",{},t),l);i.append(c);let h=[[],...n.map(()=>[])],d=null,u=null,p=()=>Math.max(160,l.clientWidth);function m(b){if(u===null)return;let S=b.valToPos(u,"x",!0),{left:y,top:C,width:E,height:v}=b.bbox;S<y||S>y+E||(b.ctx.save(),b.ctx.strokeStyle=wn("--faint"),b.ctx.lineWidth=devicePixelRatio,b.ctx.beginPath(),b.ctx.moveTo(S,C),b.ctx.lineTo(S,C+v),b.ctx.stroke(),b.ctx.restore())}function x(){d?.destroy();let b=y=>({label:y,labelSize:18,labelFont:"11px system-ui, sans-serif",font:"11px system-ui, sans-serif",stroke:wn("--ink"),grid:{stroke:wn("--line"),width:.5},ticks:{stroke:wn("--line"),width:.5},size:54}),S=[...new Set(n.map(y=>y.unit??""))].filter(Boolean);d=new Hn({width:p(),height:s,scales:{x:{time:!1},y:a?{distr:3}:{}},axes:[{...b(oo(e)),size:30},{...b(S.length===1?`[${S[0]}]`:""),...a?{grid:{show:!1},ticks:{show:!1}}:{}}],series:[{label:oo(e)},...n.map(y=>({label:oo(y),stroke:wn(y.colour),dash:y.dash??[],width:1.6,spanGaps:!1,points:r?{show:!0,size:5}:void 0}))],legend:{show:o},cursor:{drag:{x:!0,y:!1}},hooks:{draw:[m]}},h,l)}let g=()=>x();document.addEventListener("theme",g);let _=new ResizeObserver(()=>{d&&l.clientWidth&&d.width!==p()&&d.setSize({width:p(),height:s})});return _.observe(l),x(),{set(b){h=b.map(Bg),d.setData(h),l.setAttribute("aria-label",zg(t,e,n,b))},mark(b){b!==u&&(u=b,d.redraw(!1,!1))},destroy(){document.removeEventListener("theme",g),_.disconnect(),d.destroy(),c.remove()}}}var Vl=560,Wl=300;function Hg(){let i=f("input",{type:"number",min:"0.001",max:"10",step:"any",value:"0.05"}),t=f("input",{type:"file",accept:".png,.jpg,.jpeg",onchange:()=>h()}),e=f("input",{type:"number",min:"0.01",step:"any",value:"1",oninput:()=>d()}),n=f("canvas",{width:Vl,height:Wl,"aria-label":"Floor plan; click two points whose distance is known",role:"img"}),s=f("p",{class:"note","aria-live":"polite"},""),r=f("div",{hidden:!0},n,s,en("Distance between the two points [m]",e)),o=f("div",{class:"floor"},en("Picture (.png, .jpg)",t),r,en("Size of a pixel [m]",i)),a=null,l=[],c=()=>Math.min(Vl/a.width,Wl/a.height);async function h(){let[m]=t.files;l=[];try{a=m?await createImageBitmap(m):null}catch{a=null,me(`${m.name} is not a PNG or JPEG picture`,"error")}r.hidden=!a,a&&p()}n.addEventListener("click",m=>{let x=n.getBoundingClientRect(),g=[(m.clientX-x.left)*Vl/x.width/c(),(m.clientY-x.top)*Wl/x.height/c()];l=l.length===2?[g]:[...l,g],d(),p()});function d(){let m=l.length===2?Math.hypot(l[0][0]-l[1][0],l[0][1]-l[1][1]):0;m>0&&Number(e.value)>0&&(i.value=Number((Number(e.value)/m).toPrecision(4))),u()}function u(){let m=x=>(x*Number(i.value)).toFixed(1);s.textContent=l.length<2?`Click ${l.length?"the second point":"two points whose distance you know"}.`:`The picture is ${m(a.width)} m x ${m(a.height)} m.`}function p(){let m=n.getContext("2d");m.clearRect(0,0,Vl,Wl),m.drawImage(a,0,0,a.width*c(),a.height*c()),m.strokeStyle=m.fillStyle=wn("--focus"),m.lineWidth=2,m.beginPath(),l.forEach(([x,g],_)=>m[_?"lineTo":"moveTo"](x*c(),g*c())),m.stroke();for(let[x,g]of l)m.fillRect(x*c()-4,g*c()-4,8,8);u()}return i.addEventListener("input",u),{element:o,picture:t,size:i}}async function Gg(i,t,e){let n=await i.call("sources");if(!n)return;let s=async h=>{e(),c.close(),await i.step("start",h)},r=(h,d,u)=>f("li",{},f("button",{type:"button",class:"link",onclick:()=>s(u)},h),d&&f("small",{},d)),o=f("input",{type:"search","aria-label":"Filter the trials",placeholder:"filter"}),a=f("ul",{class:"sources"},n.trials.map(h=>r(h.name,h.about,{trial:h.name})));o.addEventListener("input",()=>{for(let h of a.children)h.hidden=!h.textContent.includes(o.value)});let l=f("input",{type:"file",multiple:!0,accept:".xml,.yaml,.pgm,.wkt,.geojson",onchange:()=>jb(l.files,t,s)}),c=we("Open a trial",f("div",{},f("ul",{class:"sources"},r("Empty trial",null,{}),n.files.map(h=>r(h,"file in the folder of the app",{file:h}))),en("Trials (.xml), ROS maps (.yaml with its picture), areas (.wkt, .geojson)",l),Kb(t,i,()=>c.close()),n.maps.length?Jb(n.maps,i,()=>c.close()):null,f("h3",{},"Built-in trials"),o,a),[["Cancel",()=>!0]])}async function Vg(i,t){let e=t.state.tree.children.findIndex(n=>n.tag==="stage");e<0&&await t.edit("insert",{path:[],xml:"<stage/>",position:0}),await t.edit("change",{changes:[{path:[Math.max(e,0)],name:"map",value:i}]})}function Kb(i,t,e){let n=Hg(),s=async()=>{let[r]=await Wg(n.picture.files,i),o=r&&await t.call("floor",{picture:r,resolution:Number(n.size.value)});o&&(e(),await Vg(o,t))};return f("fieldset",{},f("legend",{},"Stage from a picture of a floor plan: dark pixels are walls"),n.element,f("button",{type:"button",onclick:s},"Use as stage"))}function Jb(i,t,e){let n=s=>(e(),Vg(s,t));return f("ul",{class:"sources"},i.map(s=>f("li",{},f("button",{type:"button",class:"link",onclick:()=>n(s)},`Use the map ${s} as stage`))))}async function Wg(i,t){let e=[];for(let n of i){let s=`api/${t.connection.session}/upload?${new URLSearchParams({name:n.name})}`,r=await he(async()=>{let o=await fetch(s,{method:"POST",body:n});if(!o.ok)throw new Error((await o.text()).trim());return o.json()});if(!r)break;e.push(r.name)}return e}async function jb(i,t,e){for(let n of await Wg(i,t))me(`${n} is in the folder of the app`),n.endsWith(".xml")&&await e({file:n})}function $g(i){let t=f("input",{type:"text",value:i.state.file||"new-trial.xml"});we("Save the trial",en("Name in the folder of the app",t),[["Cancel",()=>!0],["Save",async()=>{let e=await i.call("save",{file:t.value});return e?(i.take(e),me(`saved as ${e.file}`),!0):!1}]])}var zs=([i,t])=>`x="${ze(i)}" y="${ze(t)}"`,ao=([i,t],[e,n])=>[[Math.min(i,e),Math.min(t,n)],[Math.max(i,e),Math.min(t,n)],[Math.max(i,e),Math.max(t,n)],[Math.min(i,e),Math.max(t,n)]],vd=(i,t,e)=>{let n=new Set(i.children.filter(r=>r.tag===t).map(r=>r.attributes.name||e));if(!n.has(e))return e;let s=2;for(;n.has(`${e}${s}`);)s++;return`${e}${s}`},xd=[{name:"wall",title:"Wall",key:"w",mode:"line",into:"stage",xml:i=>`<wall points="${si(i)}"/>`},{name:"obstacle",title:"Obstacle",key:"o",mode:"area",into:"stage",xml:i=>`<obstacle points="${si(i)}"/>`},{name:"walkable",title:"Walkable area",key:"g",mode:"area",attribute:["stage","walkable"]},{name:"spawner",title:"People",key:"p",mode:"two-areas",xml:i=>`<spawner count="5" zone="${si(i[0])}" goal="${si(i[1])}"/>`},{name:"source",title:"Source",key:"s",mode:"two-areas",xml:i=>`<source rate="0.5" zone="${si(i[0])}" goal="${si(i[1])}"/>`},{name:"agent",title:"Person",key:"a",mode:"arrow",xml:([i,t])=>`<agent ${zs(i)} goal="${si([t])}"/>`},{name:"way",title:"Way",key:"j",mode:"line",least:1,way:!0,xml:lm},{name:"robot",title:"Robot",key:"r",mode:"arrow",xml:([i,t],e)=>`<robot name="${vd(e,"robot","robot")}" ${zs(i)} heading="${ze(Math.atan2(t[1]-i[1],t[0]-i[0]))}">
  <goal ${zs(t)}/>
  <drive type="differential-drive"/>
  <navigator type="orca"/>
  <sensor type="lidar2d"/>
</robot>`},{name:"exit",title:"Exit",key:"e",mode:"area",xml:i=>`<exit zone="${si(i)}"/>`},{name:"portal",title:"Portal",key:"b",mode:"two-areas",xml:([i,t])=>`<portal zone="${si(i)}" dx="${ze(t[0][0]-i[0][0])}" dy="${ze(t[0][1]-i[0][1])}"/>`},{name:"cube",title:"Cube",key:"c",mode:"point",into:"stage",xml:([i])=>`<cube ${zs(i)}/>`},{name:"table",title:"Table",key:"t",mode:"point",into:"stage",xml:([i])=>`<table ${zs(i)}/>`},{name:"tree",title:"Tree",key:"v",mode:"point",into:"stage",xml:([i])=>`<tree ${zs(i)}/>`},{name:"light",title:"Light",key:"l",mode:"point",into:"stage",xml:([i])=>`<light ${zs(i)}/>`},{name:"door",title:"Door",key:"d",mode:"arrow",into:"stage",xml:(i,t)=>`<door name="${vd(Qb(t)??t,"door","door")}" points="${si(i)}"/>`},{name:"camera",title:"Camera",key:"m",mode:"arrow",xml:([i,t],e)=>`<camera name="${vd(e,"camera","camera")}" ${zs(i)} heading="${ze(Math.atan2(t[1]-i[1],t[0]-i[0]))}"/>`}],Qb=i=>i.children.find(t=>t.tag==="stage"),bd=i=>({line:1/0,area:2,"two-areas":4,point:1,arrow:2})[i.mode];function Xg(i,t){return i.way?t?"Click the next stop, or press Enter":"Click the first stop; chosen people will follow the way":i.mode==="line"?t<2?"Click the corners of the line":"Click more corners, or press Enter":i.mode==="point"?"Click the place":i.mode==="arrow"?t?"Click where it goes or looks":"Click the place":i.mode==="area"?t?"Click the opposite corner":"Click a corner":["Click a corner of the first zone","Click its opposite corner","Click a corner of the second zone","Click its opposite corner"][t]}async function wd(i,t,e){let n=e.state.tree.children.findIndex(o=>o.tag==="stage");if(i.into==="stage"&&n<0)return await e.edit("insert",{path:[],xml:"<stage/>",position:0}),wd(i,t,e);let s=i.mode==="area"?ao(t[0],t[1]):t,r=i.mode==="two-areas"?[ao(t[0],t[1]),ao(t[2],t[3])]:s;if(i.attribute){n<0&&await e.edit("insert",{path:[],xml:"<stage/>",position:0});let o=[Math.max(n,0)];return e.edit("change",{changes:[{path:o,name:i.attribute[1],value:si(s)}]})}return i.way?tw(i.xml(t,e.state.tree),e):e.insert(i.into==="stage"?[n]:[],i.xml(r,e.state.tree))}async function tw(i,t){let e=t.chosen;await t.insert([],i);let[n]=t.chosen,s=wl(t,e,t.node(n)?.attributes.name);s.length&&await t.edit("change",{changes:s})}var qg={ground:{fill:"--panel",stroke:"--line",dash:[]},wall:{stroke:"--ink",width:3,dash:[]},solid:{fill:"--line",stroke:"--ink",dash:[]},prop:{fill:"--line",stroke:"--faint",dash:[]},door:{stroke:"--data-5",width:4,dash:[]},people:{stroke:"--data-1",dash:[]},goal:{stroke:"--data-3",dash:[6,4]},target:{stroke:"--data-3",dash:[2,3]},exit:{stroke:"--data-4",dash:[10,4]},person:{fill:"--data-1",stroke:"--ink",dash:[]},robot:{fill:"--data-2",stroke:"--ink",dash:[]},camera:{stroke:"--data-4",dash:[]},light:{fill:"--data-5",stroke:"--ink",dash:[]}},Yg=9,$l=class{constructor(t,e,n){Object.assign(this,{canvas:t,model:e,tell:n,tool:null,points:[],pointer:null,drag:null,snap:.1}),this.scale=30,this.origin=[0,0],this.shapes=[],this.ways=[],this.fitted=!1,new ResizeObserver(()=>this.resize()).observe(t),t.addEventListener("pointerdown",s=>this.press(s)),t.addEventListener("pointermove",s=>this.move(s)),t.addEventListener("pointerup",s=>this.release(s)),t.addEventListener("dblclick",s=>this.tool?this.end():this.addStop(this.place(s))),t.addEventListener("wheel",s=>this.zoom(s),{passive:!1}),document.addEventListener("theme",()=>this.draw())}update(){let{tree:t}=this.model.state;this.shapes=t?zu(t):this.shapes,this.ways=t?am(t):this.ways,!this.fitted&&this.canvas.clientWidth&&this.fit(),this.draw()}fit(){let[t,e,n,s]=nm([...this.shapes,...this.model.state.rings.map(a=>({points:a}))]),{clientWidth:r,clientHeight:o}=this.canvas;this.scale=Math.min(r/(n-t),o/(s-e),200),this.origin=[r/2-(t+n)/2*this.scale,o/2+(e+s)/2*this.scale],this.fitted=!0,this.moved=!1,this.draw()}resize(){let t=window.devicePixelRatio||1;this.canvas.width=Math.round(this.canvas.clientWidth*t),this.canvas.height=Math.round(this.canvas.clientHeight*t),this.model.state&&(!this.fitted||!this.moved)?this.fit():this.draw()}use(t){this.tool=t,this.points=[],this.draw()}pixel([t,e]){return[this.origin[0]+t*this.scale,this.origin[1]-e*this.scale]}place(t){let e=this.canvas.getBoundingClientRect(),[n,s]=[t.clientX-e.left,t.clientY-e.top];return[(n-this.origin[0])/this.scale,(this.origin[1]-s)/this.scale]}snapped([t,e],n=null){let s=Yg/this.scale;for(let r of this.shapes){if(n&&hs(r.path,n))continue;let o=r.points.find(a=>Math.hypot(a[0]-t,a[1]-e)<s);if(o&&r.style!=="target")return o}return this.snap?[t,e].map(r=>Math.round(r/this.snap)*this.snap):[t,e]}press(t){if(!this.model.state?.tree)return;this.canvas.setPointerCapture(t.pointerId);let e=this.place(t);if(t.button===1||t.button===2)this.drag={kind:"pan",from:[t.clientX,t.clientY],origin:this.origin};else if(this.tool)this.points.push(this.snapped(e)),this.points.length>=bd(this.tool)&&this.end();else if(t.shiftKey&&!this.grab(e))this.drag={kind:"band",from:e,at:e};else if(this.drag=this.grab(e)??{kind:"pan",from:[t.clientX,t.clientY],origin:this.origin},this.drag.shape){let n=t.shiftKey?this.model.chosen.filter(s=>!hs(s,this.drag.shape.path)):[];this.model.choose([...n,this.drag.shape.path])}else this.model.choose([]);this.draw()}grab(t){let e=Yg/this.scale;for(let n of this.shapes){if(!this.isChosen(n)||!n.attribute)continue;let s=n.points.findIndex(r=>Math.hypot(r[0]-t[0],r[1]-t[1])<e);if(s>=0)return{kind:"corner",shape:n,index:s,from:t,at:t}}for(let n of[...this.shapes].reverse())if(this.touches(n,t,e))return{kind:"move",shape:n,from:t,at:t};for(let{path:n,stops:s}of this.ways)if(s.some(([,o],a)=>a&&Sl(t,s[a-1][1],o)<e))return{kind:"move",shape:{path:n,points:[]},from:t,at:t};return null}async addStop(t){let e=hm(this.ways,t,this.scale);if(!e)return;let[n,s]=this.snapped(t);await this.model.edit("insert",{path:e.path,xml:`<point x="${ze(n)}" y="${ze(s)}"/>`,position:e.position}),this.model.choose([[...e.path,e.position]])}chooseInside([t,e],[n,s]){let r=([a,l])=>(a-t)*(a-n)<=0&&(l-e)*(l-s)<=0,o=this.shapes.filter(a=>a.centre&&a.path.length===1&&r(a.centre));this.model.choose(o.map(a=>a.path))}touches(t,[e,n],s){if(t.radius)return Math.hypot(t.centre[0]-e,t.centre[1]-n)<Math.max(t.radius,s);let r=t.closed?[...t.points,t.points[0]]:t.points;for(let o=1;o<r.length;o++)if(Sl([e,n],r[o-1],r[o])<s)return!0;return r.length===1?Math.hypot(r[0][0]-e,r[0][1]-n)<s:t.closed&&t.style!=="ground"&&ew([e,n],t.points)}isChosen(t){return this.model.chosen.some(e=>hs(e,t.path))}move(t){if(!this.model.state?.tree)return;let e=this.place(t);if(this.pointer=this.snapped(e,this.drag?.shape?.path),this.drag?.kind==="pan"){let[n,s]=this.drag.from;this.moved=!0,this.origin=[this.drag.origin[0]+t.clientX-n,this.drag.origin[1]+t.clientY-s]}else this.drag&&(this.drag.at=this.drag.kind==="corner"?this.pointer:e);this.tell(this.words()),this.draw()}words(){let t=this.points.at(-1);if(this.tool&&t){let[e,n]=[this.pointer[0]-t[0],this.pointer[1]-t[1]];return this.tool.mode.includes("area")&&this.points.length%2?`${ze(Math.abs(e))} m x ${ze(Math.abs(n))} m`:`${ze(Math.hypot(e,n))} m`}return this.drag?.kind==="band"?"Choose the people and robots in this rectangle":this.drag?.shape?`moved by ${this.offset().map(ze).join(", ")} m`:`x ${ze(this.pointer[0])} m, y ${ze(this.pointer[1])} m`}offset(){let t=[this.drag.at[0]-this.drag.from[0],this.drag.at[1]-this.drag.from[1]];return this.snap&&this.drag.kind==="move"?t.map(e=>Math.round(e/this.snap)*this.snap):t}async release(){let t=this.drag;if(this.drag=null,t?.kind==="band"&&this.chooseInside(t.from,t.at),!t?.shape)return;this.drag=t;let[e,n]=this.offset();if(this.drag=null,!e&&!n)return this.draw();await this.model.edit("change",{changes:this.changes(t,e,n)}),this.draw()}changes({kind:t,shape:e,index:n,at:s},r,o){let a=this.model.node(e.path);return t==="corner"?em(a,e.path,e.attribute,n,s):this.model.chosen.length>1&&this.isChosen(e)?this.model.chosen.flatMap(c=>Hu(this.model.node(c),c,r,o)):a.tag==="journey"?cm(a,e.path,r,o):e.attribute?tm(a,e.path,e.attribute,r,o):Hu(a,e.path,r,o)}async end(){let{tool:t,points:e}=this;if(!t)return;let n=e.filter((r,o)=>o===0||Math.hypot(r[0]-e[o-1][0],r[1]-e[o-1][1])>1e-9);(t.mode==="line"?n.length>=(t.least??2):e.length>=bd(t))&&(this.points=[],await wd(t,t.mode==="line"?n:e,this.model))}cancel(){this.points=[],this.draw()}zoom(t){t.preventDefault();let e=this.place(t),n=this.pixel(e);this.scale=Math.min(400,Math.max(1,this.scale*Math.exp(-t.deltaY/600)));let s=this.pixel(e);this.moved=!0,this.origin=[this.origin[0]+n[0]-s[0],this.origin[1]+n[1]-s[1]],this.draw()}draw(){let t=this.canvas.getContext("2d"),e=getComputedStyle(document.documentElement);this.colour=s=>e.getPropertyValue(s).trim();let n=window.devicePixelRatio||1;t.setTransform(n,0,0,n,0,0),t.clearRect(0,0,this.canvas.clientWidth,this.canvas.clientHeight),this.drawGrid(t);for(let s of this.model.state?.rings??[])this.line(t,s,!0,qg.solid);for(let s of this.shapes)this.drawShape(t,s);um(t,this.ways,{pixel:s=>this.pixel(s),colour:this.colour,chosen:this.model.chosen}),this.drawPeople(t),this.drawPoints(t),!this.shapes.length&&!this.points.length&&this.drawHint(t),this.drag?.kind==="band"&&this.line(t,ao(this.drag.from,this.drag.at),!0,{stroke:"--focus",dash:[4,3]})}drawHint(t){t.font="15px system-ui, sans-serif",t.textAlign="center",t.fillStyle=this.colour("--faint");let e=["Choose a tool above and click into the plan,","or press Open to start with a built-in trial."],{clientWidth:n,clientHeight:s}=this.canvas;e.forEach((r,o)=>t.fillText(r,n/2,s/2+22*(o-.5))),t.textAlign="start"}drawGrid(t){let e=[.1,.5,1,5,10,50].find(r=>r*this.scale>=18)??100;t.strokeStyle=this.colour("--line"),t.globalAlpha=.35,t.lineWidth=1,t.beginPath();let{clientWidth:n,clientHeight:s}=this.canvas;for(let r=this.origin[0]%(e*this.scale);r<n;r+=e*this.scale)t.rect(r,0,0,s);for(let r=this.origin[1]%(e*this.scale);r<s;r+=e*this.scale)t.rect(0,r,n,0);t.stroke(),t.globalAlpha=1}drawShape(t,e){let n=this.isChosen(e),s=this.model.state.problems.some(c=>c.path&&hs(c.path,e.path)),r={...qg[e.style]};s&&(r.stroke="--danger"),n&&Object.assign(r,{width:(r.width??1.5)+2,stroke:s?"--danger":"--focus"});let[o,a]=n&&this.drag?.kind==="move"?this.offset():[0,0];if(e.radius){this.disc(t,[e.centre[0]+o,e.centre[1]+a],e,r);return}let l=e.points.map(([c,h])=>[c+o,h+a]);if(this.drag?.kind==="corner"&&this.drag.shape===e&&(l[this.drag.index]=this.drag.at),this.line(t,l,e.closed,r),n&&e.attribute)for(let c of l)this.handle(t,c)}line(t,e,n,s){t.beginPath(),e.forEach((r,o)=>t[o?"lineTo":"moveTo"](...this.pixel(r))),n&&t.closePath(),this.paint(t,s,n),e.length===1&&this.handle(t,e[0])}disc(t,e,n,s){let[r,o]=this.pixel(e),a=Math.max(n.radius*this.scale,4);t.beginPath(),t.arc(r,o,a,0,2*Math.PI),this.paint(t,s,!0),n.heading!==null&&(t.beginPath(),t.moveTo(r,o),t.lineTo(r+2*a*Math.cos(n.heading),o-2*a*Math.sin(n.heading)),t.stroke())}paint(t,e,n){t.setLineDash(e.dash??[]),t.lineWidth=e.width??1.5,t.strokeStyle=this.colour(e.stroke),n&&e.fill&&(t.fillStyle=this.colour(e.fill),t.globalAlpha=.7,t.fill(),t.globalAlpha=1),t.stroke(),t.setLineDash([])}handle(t,e){let[n,s]=this.pixel(e);t.fillStyle=this.colour("--focus"),t.fillRect(n-4,s-4,8,8)}drawPeople(t){let e=this.model.people;if(e){t.globalAlpha=.6;for(let n of e.ways)this.line(t,n,!1,{stroke:"--data-3",width:1,dash:[3,3]});e.people.forEach((n,s)=>this.disc(t,n,{radius:e.radii[s],heading:null},{fill:"--data-1",stroke:"--ink"})),t.globalAlpha=1}}drawPoints(t){if(!this.tool||!this.pointer)return;let e={stroke:"--focus",width:2,dash:[4,3]},n=[...this.points,this.pointer];if(!this.tool.mode.includes("area")){this.line(t,n,!1,e);return}for(let s=0;s<n.length;s+=2)n[s+1]&&this.line(t,ao(n[s],n[s+1]),!0,e)}};function ew([i,t],e){let n=!1;for(let s=0,r=e.length-1;s<e.length;r=s++){let[[o,a],[l,c]]=[e[s],e[r]];a>t!=c>t&&i<(l-o)*(t-a)/(c-a)+o&&(n=!n)}return n}var nw=400,Xl=class{constructor(t,e){Object.assign(this,{model:e,timer:0,base:"",offline:!1}),this.numbers=f("pre",{class:"numbers","aria-hidden":"true"}),this.area=f("textarea",{spellcheck:"false","aria-label":"XML of the trial",wrap:"off",oninput:()=>this.wait()}),this.area.addEventListener("scroll",()=>this.numbers.scrollTop=this.area.scrollTop),this.area.addEventListener("blur",()=>this.send()),t.append(this.numbers,this.area)}update(){if(this.offline)return this.resume();if(!this.timer){if(this.area.value!==this.model.state.text){let t=this.area.selectionStart;this.area.value=this.model.state.text,this.area.setSelectionRange(t,t)}this.count()}}resume(){if(this.offline=!1,this.model.state.text===this.base)return void this.send();this.timer=0,this.model.emit("conflict")}count(){let t=new Set(this.model.state.problems.map(n=>n.line)),e=this.area.value.split(`
`).length;this.numbers.textContent=Array.from({length:e},(n,s)=>`${t.has(s+1)?"!":" "}${s+1}`).join(`
`)}show(t){let e=this.area.value.split(`
`),n=e.slice(0,t-1).join(`
`).length+(t>1?1:0);this.area.focus(),this.area.setSelectionRange(n,n+(e[t-1]??"").length),this.area.scrollTop=Math.max(0,(t-4)*18)}wait(){this.timer||(this.base=this.model.state.text),clearTimeout(this.timer),this.timer=setTimeout(()=>this.send(),nw),this.count()}async send(){if(!this.timer)return;if(clearTimeout(this.timer),!this.model.connection.open)return void(this.offline=!0);let t=this.area.value,e=await this.model.edit("write",{text:t});if(!e&&!this.model.connection.open)return void(this.offline=!0);this.area.value===t&&(this.timer=0,e||this.model.emit("conflict"))}async resolve(t){t?await this.model.edit("write",{text:this.area.value}):this.area.value=this.model.state.text,this.update()}};var iw=[["0.1","0.1 m"],["0.25","0.25 m"],["0.5","0.5 m"],["1","1 m"],["0","off"]],Sd=class{constructor(t,e){this.app=e,this.model=new El(e.connection),this.layout(t),this.model.on("state",()=>this.update()),this.model.on("chosen",()=>this.updateChosen()),this.model.on("people",()=>this.view.draw()),this.model.on("conflict",()=>this.askConflict()),this.addKeys()}layout(t){let e=f("canvas",{tabindex:"0","aria-label":"Trial from above; the list of elements has the same content"});this.words=f("span",{class:"words"}),this.summary=f("p",{class:"note","aria-live":"polite"}),this.view=new $l(e,this.model,r=>this.words.textContent=r),e.addEventListener("contextmenu",r=>r.preventDefault()),e.addEventListener("pointerup",()=>this.view.tool&&this.tellTool());let n={outline:f("div",{class:"outline"}),inspector:f("div",{class:"inspector"}),xml:f("div",{class:"xml"})};this.outline=new Tl(n.outline,this.model),this.inspector=new Ml(n.inspector,this.model),this.xml=new Xl(n.xml,this.model),this.problems=f("ul",{class:"problems","aria-label":"Problems"});let s=f("div",{class:"text"},f("h2",{},"XML"),n.xml);t.classList.add("editor"),pt(t,f("div",{class:"bar"},this.fileButtons(),this.tools(),this.grid()),f("div",{class:"left"},f("h2",{},"Elements"),n.outline,this.summary),f("div",{class:"middle"},f("div",{class:"view"},e,this.words),f("div",{class:"below"},this.problems,s)),f("div",{class:"right"},f("h2",{},"Chosen element"),n.inspector))}fileButtons(){let t=(e,n,s={})=>f("button",{type:"button",onclick:n,...s},e);return this.undo=t("Undo",()=>this.model.step("undo")),this.redo=t("Redo",()=>this.model.step("redo")),this.places=t("Places",()=>this.togglePlaces(),{title:"Show where people start and walk","aria-pressed":"false"}),this.run=t("Run",()=>this.runTrial(),{class:"main"}),f("span",{class:"row"},t("Open",()=>Gg(this.model,this.app,()=>this.view.fitted=!1)),t("Save",()=>$g(this.model)),this.undo,this.redo,this.places,t("Whole view",()=>this.view.fit()),this.run)}togglePlaces(){let t=!this.model.places;return this.places.setAttribute("aria-pressed",String(t)),this.model.showPlaces(t)}tools(){this.toolButtons=new Map;let t=(e,n,s,r)=>{let o=f("button",{type:"button",title:`${n} (${s})`,"aria-pressed":String(!r),onclick:()=>this.use(r)},n);return this.toolButtons.set(e,o),o};return f("span",{class:"row",role:"toolbar","aria-label":"Tools"},t("select","Select","Esc",null),xd.map(e=>t(e.name,e.title,e.key,e)))}grid(){let t=f("select",{onchange:()=>this.view.snap=Number(t.value)},iw.map(([e,n])=>f("option",{value:e},n)));return f("label",{class:"row"},"Grid",t)}use(t){this.view.use(t);for(let[e,n]of this.toolButtons)n.setAttribute("aria-pressed",String(e===(t?.name??"select")));this.tellTool()}tellTool(){this.view.tool?this.words.textContent=Xg(this.view.tool,this.view.points.length):this.words.textContent=""}addKeys(){let{keys:t}=this.app;t.add("editor",[["Escape","Select; cancel a drawing",()=>this.view.points.length?this.view.cancel():this.use(null)],["Enter","End a line",()=>this.view.end()],["Delete","Remove the chosen elements",()=>this.model.chosen.length&&this.model.edit("remove",{paths:this.model.chosen})],["u","Undo",()=>this.model.step("undo")],["U","Redo",()=>this.model.step("redo")],["f","Whole view",()=>this.view.fit()],...xd.map(e=>[e.key,`Draw: ${e.title}`,()=>this.use(e)])])}update(){let{state:t}=this.model;this.undo.disabled=!t.undo,this.redo.disabled=!t.redo,this.run.disabled=t.problems.length>0,this.outline.update(),this.inspector.update(),this.xml.update(),this.view.update(),this.updateProblems(t),this.summarize(t)}updateChosen(){let[t]=this.model.chosen;this.app.remember({element:t?.length?t.join("."):null}),this.outline.update(),this.inspector.update(),this.view.draw()}updateProblems(t){let e=r=>{r.path&&this.model.choose([r.path]),r.line&&this.xml.show(r.line)},n=r=>f("li",{},f("button",{type:"button",class:"link",onclick:()=>e(r)},r.message)),s=t.problems.length?[]:[f("li",{class:"good"},"No errors")];pt(this.problems,t.problems.map(n),s,t.remarks.map(r=>f("li",{class:"note"},r)))}summarize({tree:t,file:e,problems:n}){let s=l=>t?.children.filter(c=>c.tag===l).length??0,r=t?.children.filter(l=>l.tag==="spawner").reduce((l,c)=>l+(Number(c.attributes.count)||0),s("agent"))??0,o=(l,c,h)=>`${l} ${l===1?c:h}`,a=`${o(r,"person","people")}, ${o(s("robot"),"robot","robots")}`;this.summary.textContent=`${e||"not saved"}: ${a}, ${o(n.length,"problem","problems")}`}async runTrial(){let t=this.model.state.file||"new-trial.xml",e=await this.model.call("save",{file:t});e&&(this.model.take(e),this.app.select("simulator"),document.dispatchEvent(new CustomEvent("open-trial",{detail:{file:e.file}})))}askConflict(){we("The trial was changed in another window",f("p",{},"Your text is still in the XML pane. Which one stays?"),[["The other one",()=>{this.xml.resolve(!1)}],["My text",()=>{this.xml.resolve(!0)}]])}chooseLinked(){let t=this.app.address.get("element")??"",e=t.split(".").map(Number);/^\d+(\.\d+)*$/.test(t)&&!this.model.chosen.length&&this.model.node(e)&&this.model.choose([e])}async greet(t){this.model.table||(this.model.table=await this.model.call("table")),this.model.state=null,"revision"in t?(this.model.take(t),this.chooseLinked()):me("the editor has no state","error")}},Zg={name:"editor",title:"Editor",mount(i,t){let e=new Sd(i,t);return{tab:e,greet:n=>e.greet(n),show:()=>e.view.resize()}}};var sw="http://www.w3.org/2000/svg";var rw={success:"circle",collision:"cross",timeout:"square"};function fs(i,t,...e){let n=document.createElementNS(sw,i);for(let[s,r]of Object.entries(t))s.startsWith("on")?n.addEventListener(s.slice(2),r):n.setAttribute(s,r);return n.append(...e),n}function Kg(i,t,e,n){let s=i.flatMap(h=>h.runs.map(d=>d.values[t])).filter(h=>h!==null),r=Math.min(0,...s),o=Math.max(...s,r+1e-9),a=h=>190+510*(h-r)/(o-r),l=i.length*26+30,c=fs("svg",{viewBox:`0 0 720 ${l}`,class:"strips",role:"group","aria-label":`Runs by ${e}`});i.forEach((h,d)=>{let u=d*26+13;c.append(fs("text",{x:180,y:u+4,"text-anchor":"end"},`${h.trial} ${h.navigator}`.slice(0,30))),c.append(fs("line",{x1:190,x2:700,y1:u,y2:u,class:"axis"}));for(let p of h.runs)p.values[t]!==null&&c.append(aw(h,p,a(p.values[t]),u,n))});for(let h of ow(r,o))c.append(fs("line",{x1:a(h),x2:a(h),y1:4,y2:l-24,class:"tick"})),c.append(fs("text",{x:a(h),y:l-8,"text-anchor":"middle"},String(h)));return c}function ow(i,t){let e=(t-i)/4,n=10**Math.floor(Math.log10(e)),s=n*([1,2,5,10].find(a=>a*n>=e)??10),r=Math.ceil(i/s),o=Math.floor(t/s)-r+1;return Array.from({length:Math.max(0,o)},(a,l)=>Number(((r+l)*s).toPrecision(6)))}function aw(i,t,e,n,s){let r=rw[t.outcome]??"cross",a={circle:()=>fs("circle",{cx:e,cy:n,r:4}),square:()=>fs("rect",{x:e-4,y:n-4,width:8,height:8}),cross:()=>fs("path",{d:`M${e-4} ${n-4}L${e+4} ${n+4}M${e+4} ${n-4}L${e-4} ${n+4}`})}[r]();return a.setAttribute("class",`mark ${r}`),a.addEventListener("click",()=>s(i.number,t.seed)),a.append(fs("title",{},`seed ${t.seed}: ${t.outcome}`)),a}var lw=new Set(["success"]),Md=class{constructor(t,e){Object.assign(this,{app:e,table:null,chosen:null,onlyFailures:!0,statistic:3}),this.side=f("aside",{"aria-label":"Evaluations"}),this.main=f("div",{class:"results"},f("div",{class:"first-steps"},f("h2",{},"How well does a navigator do among people?"),f("p",{},"Each navigator drives the robot of the chosen trials, with every seed. The table compares success, time, clearance and comfort, with intervals; a click on a run opens it in the simulator, at the failure."),f("p",{},"Choose trials and navigators on the left and press Run."))),t.classList.add("evaluation"),pt(t,this.side,this.main),e.connection.on("evaluation.state",n=>this.update(n)),e.connection.on("jobs.progress",n=>n.kind==="evaluate"&&n.title===this.state?.running&&this.progress(n.share)),this.form()}call(t,e={}){return he(()=>this.app.connection.call(`evaluation.${t}`,e))}form(){this.trials=f("select",{multiple:!0,size:8}),this.navigators=f("input",{type:"text",value:"straight, orca"}),this.known=f("small",{}),this.seeds=f("input",{type:"text",value:"0:20"}),this.safety=f("input",{type:"checkbox"}),this.label=f("input",{type:"text",value:"first"}),this.runButton=f("button",{type:"submit",class:"main"},"Run"),this.cancel=f("button",{type:"button",hidden:!0,onclick:()=>this.call("cancel")},"Cancel"),this.bar=f("progress",{max:1,value:0,hidden:!0,"aria-label":"Progress of the evaluation"}),this.note=f("p",{class:"note","aria-live":"polite"}),this.list=f("ul",{class:"sources"});let t=e=>{e.preventDefault(),this.start()};pt(this.side,f("h2",{},"New evaluation"),f("form",{onsubmit:t},en("Trials (several with Ctrl or Shift)",this.trials),en("Navigators",this.navigators),this.known,en("Seeds",this.seeds),f("p",{class:"note"},"0:20 are the 20 seeds from 0 to 19."),f("label",{class:"option"},this.safety,"Each also with a safety layer"),en("Name",this.label),f("div",{class:"row"},this.runButton,this.cancel)),this.bar,this.note,f("h2",{},"Evaluations"),this.list)}async greet(t){this.update(t);let e=await this.call("sources");if(!e)return;let n=new Set([...this.trials.selectedOptions].map(o=>o.value)),s=[...e.files,...e.trials.map(o=>o.name)],r=this.app.address.get("evaluation");!this.table&&r&&t.evaluations.some(o=>o.name===r&&o.done)&&await this.open(r,!0),pt(this.trials,s.map(o=>f("option",{selected:n.size?n.has(o):o==="frontal"},o))),this.trials.selectedOptions[0]?.scrollIntoView({block:"nearest"}),this.known.textContent=`With parameters, such as "orca safety=0.2". Built-in: ${e.navigators.join(", ")}`}async start(){let t=[...this.trials.selectedOptions].map(s=>s.value),e={name:this.label.value,trials:t,navigators:this.navigators.value,seeds:this.seeds.value,safety:this.safety.checked},n=await this.call("run",e);n&&this.update(n)}update(t){let e=this.state;this.state=t;let n=!!t.running;this.runButton.disabled=n,this.cancel.hidden=!n,this.bar.hidden=!n,this.bar.value=t.share,this.note.textContent=n?`${t.running} is running`:t.problem;let s=({name:r,done:o})=>f("li",{},f("button",{type:"button",class:"link",disabled:!o,onclick:()=>this.open(r)},r),o?null:f("small",{},"not complete; run it again with the same name to continue"));pt(this.list,t.evaluations.map(s)),e?.running&&!n&&!t.problem&&this.open(e.running)}progress(t){this.bar.value=t}async open(t,e=!1){let n=await this.call("table",{name:t});if(!n)return;this.table=n;let s=Number.parseInt(e?this.app.address.get("row"):"",10);this.chosen=n.cells[s]?s:null,this.statistic=this.mostKnown(),this.app.remember({evaluation:t,row:this.chosen}),this.show()}mostKnown(){let{statistics:t,cells:e}=this.table,n=r=>e.flatMap(o=>o.runs).filter(o=>o.values[r]!==null).length,s=t.map((r,o)=>r.endsWith("-rate")?0:n(o));return s.indexOf(Math.max(...s))}show(){let{table:t}=this,e=f("select",{onchange:()=>(this.statistic=Number(e.value),this.show())},t.statistics.map((s,r)=>f("option",{value:r,selected:r===this.statistic},s))),n=this.app.connection.address("evaluation",`${t.name}/report.html`);pt(this.main,f("h2",{},t.name),f("p",{class:"note"},f("code",{},t.command)),this.rows(),f("ul",{class:"comparisons"},t.comparisons.map(s=>f("li",{},s))),f("div",{class:"row"},en("Picture of each run by",e),t.report?f("a",{href:n,target:"_blank",rel:"noopener"},"Report"):null),Kg(t.cells,this.statistic,t.statistics[this.statistic],(s,r)=>this.watch(s,r)),f("p",{class:"note"},"Circle: success. Cross: collision or error. Square: timeout. Choose a mark to watch the run."),this.runs())}rows(){let{cells:t,statistics:e}=this.table,n=["Trial","Navigator","Robot","Visible","Senses",...e,"Runs"],s=o=>f("tr",{"aria-selected":String(o.number===this.chosen)},[o.trial,o.navigator,o.robot,o.visible?"yes":"no",o.senses.join(", ")||"true people"].map(a=>f("td",{},a)),o.estimates.map(a=>f("td",{class:"number"},cw(a))),f("td",{},f("button",{type:"button",onclick:()=>this.choose(o.number)},`${o.runs.length} runs`))),r=o=>o>=5&&o<5+e.length?"number":null;return f("div",{class:"scroll",tabindex:"0",role:"region","aria-label":"Table"},f("table",{},f("thead",{},f("tr",{},n.map((o,a)=>f("th",{scope:"col",class:r(a)},o)))),f("tbody",{},t.map(s))))}choose(t){this.chosen=t,this.app.remember({row:t}),this.show()}runs(){if(this.chosen===null)return null;let t=this.table.cells[this.chosen],e=t.runs.filter(a=>!lw.has(a.outcome)),n=this.onlyFailures&&e.length?e:t.runs,s=f("input",{type:"checkbox",checked:this.onlyFailures,onchange:()=>(this.onlyFailures=s.checked,this.show())}),r=["Seed","Outcome",...this.table.statistics,"Message",""],o=a=>f("tr",{},f("td",{class:"number"},String(a.seed)),f("td",{},a.outcome),a.values.map(l=>f("td",{class:"number"},l===null?"-":l.toPrecision(3))),f("td",{},a.message),f("td",{},f("button",{type:"button",onclick:()=>this.watch(t.number,a.seed)},`Watch seed ${a.seed}`)));return f("div",{},f("h3",{},`${t.trial}, ${t.navigator}`),f("label",{class:"option"},s,`Only the ${e.length} failures`),f("table",{},f("thead",{},f("tr",{},r.map(a=>f("th",{scope:"col"},a||"Watch")))),f("tbody",{},n.slice(0,500).map(o))))}async watch(t,e){let n=await this.call("watch",{name:this.table.name,cell:t,seed:e});n&&(this.app.select("simulator"),document.dispatchEvent(new CustomEvent("open-trial",{detail:n})))}};function cw(i){let[t,...e]=i.split(" ");return e.length?[t,f("small",{},e.join(" "))]:[i]}var Jg={name:"evaluation",title:"Evaluation",mount(i,t){let e=new Md(i,t);return{tab:e,greet:n=>e.greet(n)}}};var hw=new Set("H1 H2 H3 H4 H5 H6 P BR HR UL OL LI B STRONG I EM U SUB SUP SMALL BLOCKQUOTE PRE CODE DIV SPAN TABLE CAPTION THEAD TBODY TR TD TH DL DT DD".split(" "));function jg(i){return Ed(new DOMParser().parseFromString(i,"text/html").body)}function Ed(i){return[...i.childNodes].flatMap(t=>{if(t.nodeType===Node.TEXT_NODE)return[document.createTextNode(t.data)];if(t.nodeName==="IMG"&&/^data:image\//.test(t.getAttribute("src")??"")){let n=document.createElement("img");return n.src=t.getAttribute("src"),n.alt=t.getAttribute("alt")??"",[n]}if(!hw.has(t.nodeName))return t.nodeType===Node.ELEMENT_NODE?Ed(t):[];let e=document.createElement(uw(t.nodeName));return e.append(...Ed(t)),[e]})}var uw=i=>i==="H1"?"H2":i;function t0(i,t){let e=i.map(o=>[o,dw[o.kind](o,t[o.name])]);return{element:f("div",{class:"questions"},e.map(([,o])=>o.element)),values:()=>Object.fromEntries(e.map(([o,a])=>[o.name,a.value()]).filter(([,o])=>o!==null)),missing:()=>e.filter(([o,a])=>o.required&&a.value()===null).map(([o])=>o.text)}}var Td=i=>i.required?"":" (optional)";function Qg(i,t,e=[]){return f("fieldset",{},f("legend",{},i.text+Td(i)),e[0]&&f("span",{class:"end"},e[0]),t.map(([n,s])=>f("label",{class:"option"},n,s)),e[1]&&f("span",{class:"end"},e[1]))}var dw={choice(i,t){let e=[t??[]].flat(),n=i.multiple?"checkbox":"radio",s=i.options.map(({value:o,text:a})=>[f("input",{type:n,name:i.name,value:o,checked:e.includes(o)}),a]),r=()=>{let o=s.filter(([a])=>a.checked).map(([a])=>a.value);return o.length?i.multiple?o:o[0]:null};return{element:Qg(i,s),value:r}},scale(i,t){let e=i.steps.map(r=>[f("input",{type:"radio",name:i.name,value:r,checked:r===t}),String(r)]),n=()=>{let r=e.find(([o])=>o.checked);return r?Number(r[0].value):null},s=Qg(i,e,[i.low,i.high]);return s.classList.add("scale"),{element:s,value:n}},number(i,t){let e=f("input",{type:"number",name:i.name,value:t??"",min:i.min,max:i.max,step:i.step??"any"}),n=i.text+(i.unit?` [${i.unit}]`:"")+Td(i);return{element:f("label",{class:"field"},f("span",{},n),e),value:()=>e.value===""?null:Number(e.value)}},text(i,t){let e=f("textarea",{name:i.name,rows:4,maxlength:i.most},t??"");return{element:f("label",{class:"field"},f("span",{},i.text+Td(i)),e),value:()=>e.value.trim()||null}}};var br={light:{sky:"#e6ebf1",floor:"#e9ecef",line:"#d3d9de",line10:"#c3cbd2",wall:"#dfe4e9",wallTop:"#6c7884",ground:"#d9c9ad",prop:"#c79f63",door:"#2a7f9e",ink:"#1b2733",shade:.34,sun:2,dome:1.75,start:"#0072b2",goal:"#009e73",source:"#56b4e9",exit:"#d55e00",portal:"#cc79a7",stop:"#e69f00",scan:"#d1431f",cloud:"#8a4fd0",cone:"#e69f00",force:"#c2185b",path:"#5b3fa0",robotGoal:"#d55e00",mark:"#d55e00"},dark:{sky:"#171e26",floor:"#3a444f",line:"#4a5561",line10:"#617080",wall:"#6a7886",wallTop:"#a9b7c4",ground:"#6b5d45",prop:"#a97f45",door:"#4fb3d4",ink:"#e8edf2",shade:.6,sun:2,dome:1.6,start:"#56b4e9",goal:"#2fd0a0",source:"#7cc7f0",exit:"#ff8a3d",portal:"#e79ac4",stop:"#f2b84b",scan:"#ff7a4d",cloud:"#b99cff",cone:"#f2b84b",force:"#ff5c9a",path:"#b7a1ff",robotGoal:"#ff8a3d",mark:"#ff9a52"}};var lo=[{name:"people",title:"People",visible:!0},{name:"robots",title:"Robots",visible:!0},{name:"walls",title:"Walls",visible:!0},{name:"props",title:"Props and doors",visible:!0},{name:"zones",title:"Zones",visible:!0},{name:"grid",title:"Grid of 1 m",visible:!0},{name:"shadows",title:"Shadows",visible:!0},{name:"ids",title:"Numbers",visible:!1}];function n0({count:i,who:t,pelvis:e,bones:n,body:s,scale:r,heads:o,parents:a},l,c){let h=new Float64Array(84);for(let d=0;d<i;d++){let u=84*s[t[d]],p=r[t[d]];for(let m=0;m<28;m++){let x=d*c+8*m,g=4*(d*28+m),_=n[g],b=n[g+1],S=n[g+2],y=n[g+3],C=1/Math.hypot(_,b,S,y);_*=C,b*=C,S*=C,y*=C,l[x]=b,l[x+1]=S,l[x+2]=y,l[x+3]=_;let E=a[m];if(E<0)h[0]=e[3*d],h[1]=e[3*d+1],h[2]=e[3*d+2];else{let v=d*c+8*E;e0(l[v],l[v+1],l[v+2],l[v+3],p*(o[u+3*m]-o[u+3*E]),p*(o[u+3*m+1]-o[u+3*E+1]),p*(o[u+3*m+2]-o[u+3*E+2]));for(let T=0;T<3;T++)h[3*m+T]=h[3*E+T]+ca[T]}e0(b,S,y,_,p*o[u+3*m],p*o[u+3*m+1],p*o[u+3*m+2]);for(let v=0;v<3;v++)l[x+4+v]=h[3*m+v]-ca[v];l[x+7]=0}}}var ca=new Float64Array(3);function e0(i,t,e,n,s,r,o){let a=2*(t*o-e*r),l=2*(e*s-i*o),c=2*(i*r-t*s);ca[0]=s+n*a+t*c-e*l,ca[1]=r+n*l+e*a-i*c,ca[2]=o+n*c+i*l-t*a}var fw=65535,co=class{constructor(){this.description=null,this.frame=null,this.people=0,this.heads=null,this.parents=null}describe(t,e){this.description=t,this.heads=e.arrays.heads,this.parents=e.arrays.parents,this.frame=null,this.people=0}apply(t){return!this.description||t.arrays.revision[0]!==this.description.revision?!1:(this.frame=t,this.people=t.arrays.who.length,!0)}get walkers(){return this.frame?this.frame.arrays.who.filter(t=>!this.description.people.rider[t]).length:0}get time(){return this.frame?this.frame.time:0}place(t,e){if(!this.frame)return null;let{ids:n,place:s,bots:r,botplace:o}=this.frame.arrays;if(t==="robot"){let l=r.findIndex(c=>this.description.robots[c].id===e);return l<0?null:o.subarray(5*l,5*l+5)}let a=n.indexOf(e);return a<0?null:s.subarray(5*a,5*a+5)}height(t,e){if(t==="robot")return this.description.robots.find(s=>s.id===e)?.height??1;let n=this.frame?this.frame.arrays.ids.indexOf(e):-1;return n<0?1.7:this.description.people.height[this.frame.arrays.who[n]]}pose(t,e){let{who:n,pelvis:s,bones:r}=this.frame.arrays,{body:o,scale:a}=this.description.people;n0({count:this.people,who:n,pelvis:s,bones:r,body:o,scale:a,heads:this.heads,parents:this.parents},t,e)}scans(t){if(!this.frame)return[];let e=[];return this.description.sensors.forEach((n,s)=>{if(n.kind!==t)return;let r=this.frame.arrays[`scan${s}`],o=this.frame.arrays[`cloud${s}`];r?e.push({number:s,sensor:n,points:pw(r,this.frame.arrays[`pose${s}`],n)}):o&&e.push({number:s,sensor:n,points:o})}),e}};function pw(i,t,e){let n=new Float32Array(3*i.length),[s,r,o,a,l,c,h]=t,d=0;for(let u=0;u<i.length;u++){if(i[u]===fw)continue;let p=e.first+u*e.step,m=i[u]/1e3,x=m*Math.cos(p),g=m*Math.sin(p);n[d++]=s+(1-2*(c*c+h*h))*x+2*(l*c-a*h)*g,n[d++]=r+2*(l*c+a*h)*x+(1-2*(l*l+h*h))*g,n[d++]=o+2*(l*h-a*c)*x+2*(c*h+a*l)*g}return n.subarray(0,d)}function ho(i,t,e=!0){i.beginPath(),t.forEach(([n,s],r)=>r?i.lineTo(n,s):i.moveTo(n,s)),e&&i.closePath()}function i0(i,t,e,n){let{clientWidth:s,clientHeight:r}=t.canvas,o=[[0,0],[s,0],[s,r],[0,r]].map(([c,h])=>t.place(c,h)),[a,l]=[o.map(c=>c[0]),o.map(c=>c[1])];for(let[c,h]of[[1,e.line],[10,e.line10]])if(!(c/n<9)){i.beginPath();for(let d=c*Math.floor(Math.min(...a)/c);d<=Math.max(...a);d+=c)i.moveTo(d,Math.min(...l)),i.lineTo(d,Math.max(...l));for(let d=c*Math.floor(Math.min(...l)/c);d<=Math.max(...l);d+=c)i.moveTo(Math.min(...a),d),i.lineTo(Math.max(...a),d);i.strokeStyle=h,i.lineWidth=n,i.stroke()}}function s0(i,{zones:t,robots:e},n,s){for(let r of t)ho(i,r.points),i.fillStyle=i.strokeStyle=n[r.kind],i.globalAlpha=.12,i.fill(),i.globalAlpha=1,i.lineWidth=1.5*s,i.setLineDash(r.kind==="goal"||r.kind==="exit"?[.25,.15]:[]),i.stroke(),i.setLineDash([]);i.strokeStyle=n.robotGoal,i.lineWidth=2*s;for(let{goal:r}of e)i.beginPath(),i.arc(r.x,r.y,r.tolerance,0,2*Math.PI),i.moveTo(r.x,r.y),i.lineTo(r.x,r.y+.9),i.lineTo(r.x+.5,r.y+.7),i.lineTo(r.x,r.y+.5),i.stroke()}function r0(i,t,e,n,s,r){let{stage:o}=t.description;for(let a of o.ground)mw(i,a,e,n);if(r&&(o.props.forEach((a,l)=>_w(i,a,l,t,e,n)),o.doors.forEach((a,l)=>gw(i,a,t.frame?.arrays.doors?.[l]??0,e,n))),!!s)for(let a of o.walls)ho(i,a.points,a.solid),i.strokeStyle=e.wallTop,i.fillStyle=e.wall,i.lineWidth=Math.max(2*n,a.solid?0:.06),a.solid&&!a.inner&&i.fill(),i.stroke()}function mw(i,{corners:t,heights:e},n,s){ho(i,t),i.fillStyle=n.ground,i.globalAlpha=.35+.5*Math.min(1,Math.max(...e)),i.fill(),i.globalAlpha=1,i.strokeStyle=n.wallTop,i.lineWidth=s,i.stroke()}function gw(i,t,e,n,s){let r=t.yaw+(t.kind==="hinged"?e*t.angle:0),o=t.width*(t.kind==="sliding"?1-e:1);i.beginPath(),i.moveTo(t.x,t.y),i.lineTo(t.x+o*Math.cos(r),t.y+o*Math.sin(r)),i.strokeStyle=n.door,i.lineWidth=Math.max(3*s,.06),i.stroke()}function _w(i,t,e,n,s,r){if(t.kind==="none")return;let[o,a,l]=[t.x,t.y,t.heading],c=n.frame?.arrays.propnum?.indexOf(e)??-1;if(c>=0){let[u,p,,m,x,g,_]=n.frame.arrays.props.subarray(7*c,7*c+7);[o,a,l]=[u,p,Math.atan2(2*(m*_+x*g),1-2*(g*g+_*_))]}let[h,d]=t.kind==="table"?[t.length,t.width]:[t.size??2*t.trunk,t.size??2*t.trunk];i.save(),i.translate(o,a),i.rotate(l),i.fillStyle=t.kind==="tree"?"#73543a":s.prop,i.strokeStyle=s.wallTop,i.lineWidth=r,i.beginPath(),t.kind==="tree"?i.arc(0,0,t.trunk,0,2*Math.PI):i.rect(-.5*h,-.5*d,h,d),i.fill(),i.stroke(),t.kind==="tree"&&(i.beginPath(),i.arc(0,0,t.crown,0,2*Math.PI),i.fillStyle="#5f8f4c",i.globalAlpha=.25,i.fill(),i.globalAlpha=1),i.restore()}var ql=[{to:.3,color:[86,180,233],alpha:0},{to:.5,color:[86,180,233],alpha:.35},{to:1,color:[0,158,115],alpha:.4},{to:2,color:[240,228,66],alpha:.5},{to:4,color:[230,159,0],alpha:.6},{to:1/0,color:[213,94,0],alpha:.7}],ps=[{to:1,color:"#d55e00",width:4},{to:2,color:"#e69f00",width:2.5},{to:3,color:"#56b4e9",width:1.5}];function Yl(i){let{density:t,densbox:e}=i.arrays;if(!t)return null;let n=i.columns.density,s=t.length/n,r=new Uint8ClampedArray(4*t.length);return t.forEach((o,a)=>{let l=ql.find(({to:c})=>o*.025<c);r.set(l.color,4*a),r[4*a+3]=255*l.alpha}),{width:n,height:s,data:r,x:e[0],y:e[1],cell:e[2]}}function Zl(i,t){let e=i.arrays.ttc??[];for(let n=0;n<e.length;n+=5){let s=ps.findIndex(({to:r})=>e[n+4]<r);t(s<0?ps.length-1:s,e[n],e[n+1],e[n+2],e[n+3])}}function Kl(i,t){let{paths:e}=i.arrays,n=i.columns.paths;if(!(!e||n<4))for(let s=0;s<e.length;s+=n)for(let r=s;r+3<s+n;r+=2)t(e[r],e[r+1],e[r+2],e[r+3])}function o0(i,t,e){return i==="paths"?[{color:t.path,text:`${e}, next 4.8 s`,width:2}]:i==="ttc"?ps.map(({to:n,color:s,width:r})=>({color:s,width:r,text:`collision within ${n} s`})):i!=="density"?[]:ql.slice(1).map(({to:n,color:s},r)=>({color:`rgb(${s})`,width:10,text:n===1/0?`above ${ql[r].to} people/m\xB2`:`${ql[r].to} to ${n} people/m\xB2`}))}var Jl=null;function a0(i,t){let e=Yl(t.frame);e&&(Jl??=document.createElement("canvas"),Object.assign(Jl,{width:e.width,height:e.height}),Jl.getContext("2d").putImageData(new ImageData(e.data,e.width,e.height),0,0),i.drawImage(Jl,e.x,e.y,e.width*e.cell,e.height*e.cell))}function l0(i,t,e,n){i.beginPath(),Kl(t.frame,(s,r,o,a)=>{i.moveTo(s,r),i.lineTo(o,a)}),i.strokeStyle=e.path,i.lineWidth=1.5*n,i.globalAlpha=.75,i.stroke(),i.globalAlpha=1}function c0(i,t,e,n){ps.forEach(({color:s,width:r},o)=>{i.beginPath(),Zl(t.frame,(a,l,c,h,d)=>{a===o&&(i.moveTo(l,c),i.lineTo(h,d))}),i.strokeStyle=s,i.lineWidth=r*n,i.stroke()})}var h0=.004;function f0(i,t,e,n,s){let{who:r,ids:o,place:a}=t.frame.arrays,{people:l,regions:c}=t.description,[h,d]=[c.indexOf("top"),c.indexOf("hair")];for(let u=0;u<t.people;u++){let[p,m,x,g,_]=a.subarray(5*u,5*u+5),b=l.rider[r[u]],S=b?.24:l.radius[r[u]],y=l.colors[r[u]];i.beginPath(),i.arc(p,m,S,0,2*Math.PI),i.fillStyle=e.ink,i.globalAlpha=.1,i.fill(),i.globalAlpha=1,i.strokeStyle=e.wallTop,i.lineWidth=n,i.stroke(),i.save(),i.translate(p,m),i.rotate(x),i.fillStyle=`#${y.slice(6*h,6*h+6)}`,i.strokeStyle=e.ink,i.beginPath(),i.ellipse(0,0,.55*S,.95*S,0,0,2*Math.PI),i.fill(),i.stroke(),i.fillStyle=`#${y.slice(6*d,6*d+6)}`,i.beginPath(),i.arc(.08*S,0,.42*S,0,2*Math.PI),i.fill(),i.restore(),Rd(i,p,m,p+.6*g,m+.6*_,e.ink,1.5*n),!b&&s?.kind==="person"&&s.id===o[u]&&Cd(i,p,m,S+.14,e.mark,3*n)}}function p0(i,t,e,n,s){let{bots:r,botplace:o}=t.frame.arrays;r.forEach((a,l)=>{let c=t.description.robots[a],[h,d,u]=o.subarray(5*l,5*l+5);i.save(),i.translate(h,d),i.rotate(u),i.globalAlpha=c.ghost?.4:1,ho(i,c.footprint),i.fillStyle=e.robotGoal,i.strokeStyle=e.ink,i.lineWidth=1.5*n,i.fill(),i.stroke();let p=.55*c.radius;ho(i,[[p,0],[-.5*p,.7*p],[-.5*p,-.7*p]]),i.fillStyle=e.floor,i.fill(),i.restore(),s?.kind==="robot"&&s.id===c.id&&Cd(i,h,d,c.radius+.14,e.mark,3*n)})}function m0(i,t,e,n,s,r){let{who:o,ids:a,place:l,bots:c,botplace:h}=t.frame.arrays,{people:d,robots:u}=t.description;for(let p=0;r&&p<t.people;p++)d.rider[o[p]]||d0(i,String(a[p]),l[5*p],l[5*p+1]+d.radius[o[p]]+4*n,e,n);for(let p=0;s&&p<c.length;p++){let{name:m,radius:x}=u[c[p]];d0(i,m,h[5*p],h[5*p+1]+x+6*n,e,n)}}var Ad=[{name:"density",under:!0,draw:a0},{name:"paths",under:!0,draw:l0},{name:"ttc",under:!0,draw:c0},{name:"ranges",under:!0,draw:yw},{name:"goals",under:!0,draw:vw},{name:"scans",under:!1,draw:(...i)=>u0("scan",3,...i)},{name:"clouds",under:!1,draw:(...i)=>u0("cloud",1.5,...i)},{name:"forces",under:!1,draw:xw}];function u0(i,t,e,n,s,r){e.fillStyle=s[i];let o=t*r;for(let{points:a}of n.scans(i))for(let l=0;l<a.length;l+=3)e.fillRect(a[l]-.5*o,a[l+1]-.5*o,o,o)}function yw(i,t,e){let n=t.frame.arrays.cones??[],s=t.description.sensors.filter(r=>r.kind==="cone");i.fillStyle=e.cone,i.globalAlpha=.3;for(let r=0;r<n.length/9;r++){let[o,a,,l,c,h,d,u]=n.subarray(9*r,9*r+9),p=Math.atan2(2*(l*d+c*h),1-2*(h*h+d*d)),m=s[r]?.angle??.2;i.beginPath(),i.moveTo(o,a),i.arc(o,a,u,p-m,p+m),i.closePath(),i.fill()}i.globalAlpha=1}function vw(i,t,e,n){let{goals:s,place:r}=t.frame.arrays;if(s){i.globalAlpha=.5,i.setLineDash([6*n,5*n]);for(let o=0;o<t.people;o++)Number.isFinite(s[2*o])&&Rd(i,r[5*o],r[5*o+1],s[2*o],s[2*o+1],e.goal,1.5*n);i.setLineDash([]),i.globalAlpha=1}}function xw(i,t,e,n){let s=t.frame.arrays.forces??[];for(let r=0;r<s.length/6;r++){let[o,a,,l,c]=s.subarray(6*r,6*r+6);Rd(i,o,a,o+h0*l,a+h0*c,e.force,3*n),Cd(i,o,a,.05,e.force,2*n)}}function Rd(i,t,e,n,s,r,o){i.beginPath(),i.moveTo(t,e),i.lineTo(n,s),i.strokeStyle=r,i.lineWidth=o,i.stroke()}function Cd(i,t,e,n,s,r){i.beginPath(),i.arc(t,e,n,0,2*Math.PI),i.strokeStyle=s,i.lineWidth=r,i.stroke()}function d0(i,t,e,n,s,r){i.save();let{a:o,b:a,e:l,f:c,c:h,d}=i.getTransform(),u=Math.hypot(o,a)*r;i.setTransform(u,0,0,u,o*e+h*n+l,a*e+d*n+c),i.font="12px system-ui, sans-serif",i.textAlign="center",i.strokeStyle=s.floor,i.lineWidth=3,i.lineJoin="round",i.strokeText(t,0,0),i.fillStyle=s.ink,i.fillText(t,0,0),i.restore()}var jl=class{constructor(t,e){this.canvas=t,this.x=0,this.y=0,this.scale=30,this.turn=0,this._changed=e,this._listeners=new AbortController;let n=(s,r,o)=>t.addEventListener(s,r,{signal:this._listeners.signal,...o});n("pointerdown",s=>this._press(s)),n("pointermove",s=>this._drag(s)),n("pointerup",()=>this._from=null),n("wheel",s=>this._wheel(s),{passive:!1}),n("keydown",s=>this._key(s))}fit([t,e,n,s]){let{clientWidth:r,clientHeight:o}=this.canvas;this.x=.5*(t+n),this.y=.5*(e+s),this.scale=.96*Math.min((r||800)/(n-t),(o||600)/(s-e)),this.turn=0}point(t,e){let[n,s]=[t-this.x,e-this.y],[r,o]=[Math.cos(this.turn),Math.sin(this.turn)];return[.5*this.canvas.clientWidth+this.scale*(r*n-o*s),.5*this.canvas.clientHeight-this.scale*(o*n+r*s)]}place(t,e){let n=(t-.5*this.canvas.clientWidth)/this.scale,s=-(e-.5*this.canvas.clientHeight)/this.scale,[r,o]=[Math.cos(this.turn),Math.sin(this.turn)];return[this.x+r*n+o*s,this.y-o*n+r*s]}enter(t,e){let n=e*this.scale,[s,r]=[Math.cos(this.turn),Math.sin(this.turn)],[o,a]=this.point(0,0);t.setTransform(n*s,-n*r,-n*r,-n*s,e*o,e*a)}dispose(){this._listeners.abort()}_press(t){this._from=[t.clientX,t.clientY],this.canvas.setPointerCapture(t.pointerId)}_drag(t){if(!this._from)return;let[e,n]=this._from;this._move(t.clientX-e,t.clientY-n),this._from=[t.clientX,t.clientY]}_move(t,e){let n=this.place(0,0),s=this.place(t,e);this.x-=s[0]-n[0],this.y-=s[1]-n[1],this._changed()}_wheel(t){t.preventDefault();let e=this.canvas.getBoundingClientRect();this._zoom(Math.exp(-.0015*t.deltaY),t.clientX-e.left,t.clientY-e.top)}_zoom(t,e,n){let s=this.place(e,n);this.scale=Math.min(400,Math.max(2,this.scale*t));let r=this.place(e,n);this.x+=s[0]-r[0],this.y+=s[1]-r[1],this._changed()}_key(t){if(!t.shiftKey)return;let e={ArrowLeft:[60,0],ArrowRight:[-60,0],ArrowUp:[0,60],ArrowDown:[0,-60]}[t.key],n={"+":1.25,"*":1.25,_:.8}[t.key];!e&&!n||(t.preventDefault(),e?this._move(...e):this._zoom(n,.5*this.canvas.clientWidth,.5*this.canvas.clientHeight))}};var bw=70,Ql=class{constructor(t,e){this.canvas=t,this.state=new co,this._resource=e,this._context=t.getContext("2d"),this._layers=new Map(lo.filter(n=>n.name!=="shadows").map(n=>[n.name,{...n}])),this._camera="free",this._mark=null,this._frames=0,this._look=br.light,this._theme="light",this._view=new jl(t,()=>{this._camera!=="follow"&&(this._camera="free"),this.render()})}async load(t){this._bodies??=await this._fetch("bodies/2.bin");let e=JSON.stringify(this.state.description?.bounds)!==JSON.stringify(t.bounds);this.state.describe(t,this._bodies);for(let{name:n,title:s}of t.layers)this._layers.has(n)||this._layers.set(n,{name:n,title:s,visible:n==="scans"});e&&this._view.fit(t.bounds)}apply(t){return this.state.apply(t)}layers(){return[...this._layers.values()].map(t=>({...t}))}wanted(){let t=new Set(lo.map(e=>e.name));return this.layers().filter(e=>e.visible&&!t.has(e.name)).map(e=>e.name)}setLayer(t,e){if(!this._layers.has(t))throw new Error(`the scene has no layer ${t}`);this._layers.get(t).visible=e}cameras(){return this.state.description?[{name:"free",title:"Free"},{name:"overview",title:"Overview"},{name:"follow",title:"Follow"},...this.state.description.robots.map(t=>({name:`robot:${t.name}`,title:`From ${t.name}`}))]:[]}get camera(){return this._camera}setCamera(t,e=null){this._camera=t,e&&(this._mark=e),this._view.turn=0,t==="overview"&&this._view.fit(this.state.description.bounds),(t==="follow"||t.startsWith("robot:"))&&(this._view.scale=bw)}reset(){this._camera="free",this._view.fit(this.state.description.bounds)}pick(t,e){if(!this.state.frame)return null;let[n,s]=this._view.place(t,e),{ids:r,place:o,bots:a,botplace:l}=this.state.frame.arrays,c=null,h=(d,u,p,m,x)=>{let g=Math.hypot(p-n,m-s)/x;g<=1&&(!c||g<c.away)&&(c={kind:d,id:u,away:g})};return a.forEach((d,u)=>{let p=this.state.description.robots[d];h("robot",p.id,l[5*u],l[5*u+1],p.radius+.05)}),r.forEach((d,u)=>h("person",d,o[5*u],o[5*u+1],.35)),c&&{kind:c.kind,id:c.id}}floor(t,e){let[n,s]=this._view.place(t,e);return{x:n,y:s}}highlight(t,e){this._mark=t==null?null:{kind:t,id:e}}setTheme(t){this._theme=t==="dark"?"dark":"light",this._look=br[this._theme]}info(){return{people:this.state.walkers,robots:this.state.frame?this.state.frame.arrays.bots.length:0,levels:[0,0,0],time:this.state.time,sequence:this.state.frame?this.state.frame.sequence:0,calls:0,triangles:0,frames:this._frames,milliseconds:this._spent??0,camera:this._camera,eye:[this._view.x,this._view.y,this._view.scale],theme:this._theme}}render(){let t=performance.now(),e=this._resize(),{_context:n,_look:s,state:r}=this;if(n.setTransform(1,0,0,1,0,0),n.fillStyle=s.floor,n.fillRect(0,0,this.canvas.width,this.canvas.height),r.description){this._lead(),this._view.enter(n,e);let o=l=>this._layers.get(l)?.visible??!1,a=1/this._view.scale;o("grid")&&i0(n,this._view,s,a),o("zones")&&s0(n,r.description,s,a),r0(n,r,s,a,o("walls"),o("props")),r.frame&&this._figures(o,a)}this._frames+=1,this._spent=performance.now()-t}dispose(){this._view.dispose()}_figures(t,e){let{_context:n,_look:s,state:r}=this;for(let{name:o,under:a,draw:l}of Ad)a&&t(o)&&l(n,r,s,e);t("robots")&&p0(n,r,s,e,this._mark),t("people")&&f0(n,r,s,e,this._mark);for(let{name:o,under:a,draw:l}of Ad)!a&&t(o)&&l(n,r,s,e);m0(n,r,s,e,t("robots"),t("people")&&t("ids"))}_lead(){let{state:t}=this;if(!t.frame||this._camera==="free"||this._camera==="overview")return;let e=this._mark;if(this._camera.startsWith("robot:")){let s=t.description.robots.find(r=>`robot:${r.name}`===this._camera);e=s&&{kind:"robot",id:s.id}}else!e&&t.frame.arrays.bots.length&&(e={kind:"robot",id:t.description.robots[t.frame.arrays.bots[0]].id});let n=e&&t.place(e.kind,e.id);n&&([this._view.x,this._view.y]=n,this._view.turn=this._camera==="follow"?0:.5*Math.PI-n[2])}async _fetch(t){let e=await fetch(this._resource(t));if(!e.ok)throw new Error(`${t}: ${(await e.text()).trim()}`);return Fs(await e.arrayBuffer())}_resize(){let t=Math.min(2,devicePixelRatio||1),[e,n]=[Math.round(t*this.canvas.clientWidth),Math.round(t*this.canvas.clientHeight)];return e&&n&&(this.canvas.width!==e||this.canvas.height!==n)&&(this.canvas.width=e,this.canvas.height=n),t}};var rr={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},or={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},j0=0,uf=1,Q0=2;var Pr=1,t_=2,Bo=3,ar=0,li=1,$n=2,Ir=0,zo=1,df=2,ff=3,pf=4,e_=5;var Lr=100,n_=101,i_=102,s_=103,r_=104,o_=200,a_=201,l_=202,c_=203,mf=204,gf=205,h_=206,u_=207,d_=208,f_=209,p_=210,m_=211,g_=212,__=213,y_=214,Cc=0,Pc=1,Ic=2,To=3,Lc=4,Dc=5,Nc=6,Uc=7,oh=0,v_=1,x_=2,es=0,_f=1,yf=2,vf=3,xf=4,bf=5,wf=6,Sf=7;var Mf=300,Dr=301,Ho=302,ah=303,lh=304,Ao=1e3,Qi=1001,Fc=1002,Bn=1003,b_=1004;var Xa=1005;var Vn=1006,ch=1007;var Ts=1008;var ci=1009,Ef=1010,Tf=1011,Go=1012,hh=1013,Gi=1014,Jn=1015,Vi=1016,uh=1017,dh=1018,Nr=1020,Af=35902,Rf=35899,Cf=1021,Pf=1022,Cn=1023,bs=1026,As=1027,If=1028,fh=1029,lr=1030,ph=1031;var mh=1033,qa=33776,Ya=33777,Za=33778,Ka=33779,gh=35840,_h=35841,yh=35842,vh=35843,xh=36196,bh=37492,wh=37496,Sh=37488,Mh=37489,Ja=37490,Eh=37491,Th=37808,Ah=37809,Rh=37810,Ch=37811,Ph=37812,Ih=37813,Lh=37814,Dh=37815,Nh=37816,Uh=37817,Fh=37818,Oh=37819,kh=37820,Bh=37821,zh=36492,Hh=36494,Gh=36495,Vh=36283,Wh=36284,ja=36285,$h=36286;var va=2300,Oc=2301,Ac=2302,jd=2303,Qd=2400,tf=2401,ef=2402;var w_=3200;var Qa=0,S_=1,Rs="",sn="srgb",xa="srgb-linear",ba="linear",Pe="srgb";var Rc=7680;var M_=519,E_=512,T_=513,A_=514,Lf=515,R_=516,C_=517,Df=518,Nf=519,P_=35044,Ur=35048;var Uf="300 es",Ai=2e3,Ro=2001;function ww(i){for(let t=i.length-1;t>=0;--t)if(i[t]>=65535)return!0;return!1}function Sw(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function wa(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function I_(){let i=wa("canvas");return i.style.display="block",i}var g0={},Co=null;function Ff(...i){let t="THREE."+i.shift();Co?Co("log",t,...i):console.log(t,...i)}function L_(i){let t=i[0];if(typeof t=="string"&&t.startsWith("TSL:")){let e=i[1];e&&e.isStackTrace?i[0]+=" "+e.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function Yt(...i){i=L_(i);let t="THREE."+i.shift();if(Co)Co("warn",t,...i);else{let e=i[0];e&&e.isStackTrace?console.warn(e.getError(t)):console.warn(t,...i)}}function te(...i){i=L_(i);let t="THREE."+i.shift();if(Co)Co("error",t,...i);else{let e=i[0];e&&e.isStackTrace?console.error(e.getError(t)):console.error(t,...i)}}function ga(...i){let t=i.join(" ");t in g0||(g0[t]=!0,Yt(...i))}function D_(i,t,e){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(t,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:n()}}setTimeout(r,e)})}var N_={[Cc]:Cc,[Ic]:Nc,[Lc]:Lc,[To]:Dc,[Pc]:Pc,[Nc]:Ic,[Uc]:Uc,[Dc]:To},Bi=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[t]===void 0&&(n[t]=[]),n[t].indexOf(e)===-1&&n[t].push(e)}hasEventListener(t,e){let n=this._listeners;return n===void 0?!1:n[t]!==void 0&&n[t].indexOf(e)!==-1}removeEventListener(t,e){let n=this._listeners;if(n===void 0)return;let s=n[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){let e=this._listeners;if(e===void 0)return;let n=e[t.type];if(n!==void 0){t.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},qn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],_0=1234567,_a=Math.PI/180,Po=180/Math.PI;function Vo(){let i=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(qn[i&255]+qn[i>>8&255]+qn[i>>16&255]+qn[i>>24&255]+"-"+qn[t&255]+qn[t>>8&255]+"-"+qn[t>>16&15|64]+qn[t>>24&255]+"-"+qn[e&63|128]+qn[e>>8&255]+"-"+qn[e>>16&255]+qn[e>>24&255]+qn[n&255]+qn[n>>8&255]+qn[n>>16&255]+qn[n>>24&255]).toLowerCase()}function ge(i,t,e){return Math.max(t,Math.min(e,i))}function Of(i,t){return(i%t+t)%t}function Mw(i,t,e,n,s){return n+(i-t)*(s-n)/(e-t)}function Ew(i,t,e){return i!==t?(e-i)/(t-i):0}function ya(i,t,e){return(1-e)*i+e*t}function Tw(i,t,e,n){return ya(i,t,1-Math.exp(-e*n))}function Aw(i,t=1){return t-Math.abs(Of(i,t*2)-t)}function Rw(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*(3-2*i))}function Cw(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*i*(i*(i*6-15)+10))}function Pw(i,t){return i+Math.floor(Math.random()*(t-i+1))}function Iw(i,t){return i+Math.random()*(t-i)}function Lw(i){return i*(.5-Math.random())}function Dw(i){i!==void 0&&(_0=i);let t=_0+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function Nw(i){return i*_a}function Uw(i){return i*Po}function Fw(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function Ow(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function kf(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function kw(i,t,e,n,s){let r=Math.cos,o=Math.sin,a=r(e/2),l=o(e/2),c=r((t+n)/2),h=o((t+n)/2),d=r((t-n)/2),u=o((t-n)/2),p=r((n-t)/2),m=o((n-t)/2);switch(s){case"XYX":i.set(a*h,l*d,l*u,a*c);break;case"YZY":i.set(l*u,a*h,l*d,a*c);break;case"ZXZ":i.set(l*d,l*u,a*h,a*c);break;case"XZX":i.set(a*h,l*m,l*p,a*c);break;case"YXY":i.set(l*p,a*h,l*m,a*c);break;case"ZYZ":i.set(l*m,l*p,a*h,a*c);break;default:Yt("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function Bf(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function U_(i,t){if(t.constructor===Float32Array)return i;let e=Bf(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/e,-1)}function F_(i,t){if(t.constructor===Float32Array)return i;let e=Bf(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*e)}var Wo={DEG2RAD:_a,RAD2DEG:Po,generateUUID:Vo,clamp:ge,euclideanModulo:Of,mapLinear:Mw,inverseLerp:Ew,lerp:ya,damp:Tw,pingpong:Aw,smoothstep:Rw,smootherstep:Cw,randInt:Pw,randFloat:Iw,randFloatSpread:Lw,seededRandom:Dw,degToRad:Nw,radToDeg:Uw,isPowerOfTwo:Fw,ceilPowerOfTwo:Ow,floorPowerOfTwo:kf,setQuaternionFromProperEuler:kw,normalize:F_,denormalize:U_},Vt=class{static{this.prototype.isVector2=!0}constructor(t=0,e=0){this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("THREE.Vector2: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,n=this.y,s=t.elements;return this.x=s[0]*e+s[3]*n+s[6],this.y=s[1]*e+s[4]*n+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=ge(this.x,t.x,e.x),this.y=ge(this.y,t.y,e.y),this}clampScalar(t,e){return this.x=ge(this.x,t,e),this.y=ge(this.y,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ge(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(ge(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y;return e*e+n*n}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let n=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*n-o*s+t.x,this.y=r*s+o*n+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},ai=class{constructor(t=0,e=0,n=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=n,this._w=s}static slerpFlat(t,e,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],d=n[s+3],u=r[o+0],p=r[o+1],m=r[o+2],x=r[o+3];if(d!==x||l!==u||c!==p||h!==m){let g=l*u+c*p+h*m+d*x;g<0&&(u=-u,p=-p,m=-m,x=-x,g=-g);let _=1-a;if(g<.9995){let b=Math.acos(g),S=Math.sin(b);_=Math.sin(_*b)/S,a=Math.sin(a*b)/S,l=l*_+u*a,c=c*_+p*a,h=h*_+m*a,d=d*_+x*a}else{l=l*_+u*a,c=c*_+p*a,h=h*_+m*a,d=d*_+x*a;let b=1/Math.sqrt(l*l+c*c+h*h+d*d);l*=b,c*=b,h*=b,d*=b}}t[e]=l,t[e+1]=c,t[e+2]=h,t[e+3]=d}static multiplyQuaternionsFlat(t,e,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],d=r[o],u=r[o+1],p=r[o+2],m=r[o+3];return t[e]=a*m+h*d+l*p-c*u,t[e+1]=l*m+h*u+c*d-a*p,t[e+2]=c*m+h*p+a*u-l*d,t[e+3]=h*m-a*d-l*u-c*p,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,n,s){return this._x=t,this._y=e,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let n=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),d=a(r/2),u=l(n/2),p=l(s/2),m=l(r/2);switch(o){case"XYZ":this._x=u*h*d+c*p*m,this._y=c*p*d-u*h*m,this._z=c*h*m+u*p*d,this._w=c*h*d-u*p*m;break;case"YXZ":this._x=u*h*d+c*p*m,this._y=c*p*d-u*h*m,this._z=c*h*m-u*p*d,this._w=c*h*d+u*p*m;break;case"ZXY":this._x=u*h*d-c*p*m,this._y=c*p*d+u*h*m,this._z=c*h*m+u*p*d,this._w=c*h*d-u*p*m;break;case"ZYX":this._x=u*h*d-c*p*m,this._y=c*p*d+u*h*m,this._z=c*h*m-u*p*d,this._w=c*h*d+u*p*m;break;case"YZX":this._x=u*h*d+c*p*m,this._y=c*p*d+u*h*m,this._z=c*h*m-u*p*d,this._w=c*h*d-u*p*m;break;case"XZY":this._x=u*h*d-c*p*m,this._y=c*p*d-u*h*m,this._z=c*h*m+u*p*d,this._w=c*h*d+u*p*m;break;default:Yt("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let n=e/2,s=Math.sin(n);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,n=e[0],s=e[4],r=e[8],o=e[1],a=e[5],l=e[9],c=e[2],h=e[6],d=e[10],u=n+a+d;if(u>0){let p=.5/Math.sqrt(u+1);this._w=.25/p,this._x=(h-l)*p,this._y=(r-c)*p,this._z=(o-s)*p}else if(n>a&&n>d){let p=2*Math.sqrt(1+n-a-d);this._w=(h-l)/p,this._x=.25*p,this._y=(s+o)/p,this._z=(r+c)/p}else if(a>d){let p=2*Math.sqrt(1+a-n-d);this._w=(r-c)/p,this._x=(s+o)/p,this._y=.25*p,this._z=(l+h)/p}else{let p=2*Math.sqrt(1+d-n-a);this._w=(o-s)/p,this._x=(r+c)/p,this._y=(l+h)/p,this._z=.25*p}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let n=t.dot(e)+1;return n<1e-8?(n=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=n):(this._x=0,this._y=-t.z,this._z=t.y,this._w=n)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=n),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(ge(this.dot(t),-1,1)))}rotateTowards(t,e){let n=this.angleTo(t);if(n===0)return this;let s=Math.min(1,e/n);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=e._x,l=e._y,c=e._z,h=e._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=this.dot(t);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-e;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,e=Math.sin(e*c)/h,this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this._onChangeCallback()}else this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this.normalize();return this}slerpQuaternions(t,e,n){return this.copy(t).slerp(e,n)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},H=class{static{this.prototype.isVector3=!0}constructor(t=0,e=0,n=0){this.x=t,this.y=e,this.z=n}set(t,e,n){return n===void 0&&(n=this.z),this.x=t,this.y=e,this.z=n,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("THREE.Vector3: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(y0.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(y0.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*n+r[6]*s,this.y=r[1]*e+r[4]*n+r[7]*s,this.z=r[2]*e+r[5]*n+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,n=this.y,s=this.z,r=t.x,o=t.y,a=t.z,l=t.w,c=2*(o*s-a*n),h=2*(a*e-r*s),d=2*(r*n-o*e);return this.x=e+l*c+o*d-a*h,this.y=n+l*h+a*c-r*d,this.z=s+l*d+r*h-o*c,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*n+r[8]*s,this.y=r[1]*e+r[5]*n+r[9]*s,this.z=r[2]*e+r[6]*n+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=ge(this.x,t.x,e.x),this.y=ge(this.y,t.y,e.y),this.z=ge(this.z,t.z,e.z),this}clampScalar(t,e){return this.x=ge(this.x,t,e),this.y=ge(this.y,t,e),this.z=ge(this.z,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ge(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let n=t.x,s=t.y,r=t.z,o=e.x,a=e.y,l=e.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let n=t.dot(this)/e;return this.copy(t).multiplyScalar(n)}projectOnPlane(t){return Pd.copy(this).projectOnVector(t),this.sub(Pd)}reflect(t){return this.sub(Pd.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(ge(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y,s=this.z-t.z;return e*e+n*n+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,n){let s=Math.sin(e)*t;return this.x=s*Math.sin(n),this.y=Math.cos(e)*t,this.z=s*Math.cos(n),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,n){return this.x=t*Math.sin(e),this.y=n,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),n=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=n,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,n=Math.sqrt(1-e*e);return this.x=n*Math.cos(t),this.y=e,this.z=n*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},Pd=new H,y0=new ai,ne=class{static{this.prototype.isMatrix3=!0}constructor(t,e,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c)}set(t,e,n,s,r,o,a,l,c){let h=this.elements;return h[0]=t,h[1]=s,h[2]=a,h[3]=e,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],this}extractBasis(t,e,n){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],d=n[7],u=n[2],p=n[5],m=n[8],x=s[0],g=s[3],_=s[6],b=s[1],S=s[4],y=s[7],C=s[2],E=s[5],v=s[8];return r[0]=o*x+a*b+l*C,r[3]=o*g+a*S+l*E,r[6]=o*_+a*y+l*v,r[1]=c*x+h*b+d*C,r[4]=c*g+h*S+d*E,r[7]=c*_+h*y+d*v,r[2]=u*x+p*b+m*C,r[5]=u*g+p*S+m*E,r[8]=u*_+p*y+m*v,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8];return e*o*h-e*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],d=h*o-a*c,u=a*l-h*r,p=c*r-o*l,m=e*d+n*u+s*p;if(m===0)return this.set(0,0,0,0,0,0,0,0,0);let x=1/m;return t[0]=d*x,t[1]=(s*c-h*n)*x,t[2]=(a*n-s*o)*x,t[3]=u*x,t[4]=(h*e-s*l)*x,t[5]=(s*r-a*e)*x,t[6]=p*x,t[7]=(n*l-c*e)*x,t[8]=(o*e-n*r)*x,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+t,-s*c,s*l,-s*(-c*o+l*a)+a+e,0,0,1),this}scale(t,e){return ga("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Id.makeScale(t,e)),this}rotate(t){return ga("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Id.makeRotation(-t)),this}translate(t,e){return ga("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Id.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,n,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<9;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<9;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t}clone(){return new this.constructor().fromArray(this.elements)}},Id=new ne,v0=new ne().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),x0=new ne().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function Bw(){let i={enabled:!0,workingColorSpace:xa,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Pe&&(s.r=xs(s.r),s.g=xs(s.g),s.b=xs(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Pe&&(s.r=Eo(s.r),s.g=Eo(s.g),s.b=Eo(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===Rs?ba:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],e=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[xa]:{primaries:t,whitePoint:n,transfer:ba,toXYZ:v0,fromXYZ:x0,luminanceCoefficients:e,workingColorSpaceConfig:{unpackColorSpace:sn},outputColorSpaceConfig:{drawingBufferColorSpace:sn}},[sn]:{primaries:t,whitePoint:n,transfer:Pe,toXYZ:v0,fromXYZ:x0,luminanceCoefficients:e,outputColorSpaceConfig:{drawingBufferColorSpace:sn}}}),i}var xe=Bw();function xs(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function Eo(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var uo,kc=class{static getDataURL(t,e="image/png"){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let n;if(t instanceof HTMLCanvasElement)n=t;else{uo===void 0&&(uo=wa("canvas")),uo.width=t.width,uo.height=t.height;let s=uo.getContext("2d");t instanceof ImageData?s.putImageData(t,0,0):s.drawImage(t,0,0,t.width,t.height),n=uo}return n.toDataURL(e)}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=wa("canvas");e.width=t.width,e.height=t.height;let n=e.getContext("2d");n.drawImage(t,0,0,t.width,t.height);let s=n.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=xs(r[o]/255)*255;return n.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let n=0;n<e.length;n++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[n]=Math.floor(xs(e[n]/255)*255):e[n]=xs(e[n]);return{data:e,width:t.width,height:t.height}}else return Yt("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},zw=0,Io=class{constructor(t=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:zw++}),this.uuid=Vo(),this.data=t,this.dataReady=!0,this.version=0}getSize(t){let e=this.data;return typeof HTMLVideoElement<"u"&&e instanceof HTMLVideoElement?t.set(e.videoWidth,e.videoHeight,0):typeof VideoFrame<"u"&&e instanceof VideoFrame?t.set(e.displayWidth,e.displayHeight,0):e!==null?t.set(e.width||0,e.height||0,e.depth||0):t.set(0,0,0),t}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(Ld(s[o].image)):r.push(Ld(s[o]))}else r=Ld(s);n.url=r}return e||(t.images[this.uuid]=n),n}};function Ld(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?kc.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(Yt("Texture: Unable to serialize Texture."),{})}var Hw=0,Dd=new H,Zn=class i extends Bi{constructor(t=i.DEFAULT_IMAGE,e=i.DEFAULT_MAPPING,n=Qi,s=Qi,r=Vn,o=Ts,a=Cn,l=ci,c=i.DEFAULT_ANISOTROPY,h=Rs){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:Hw++}),this.uuid=Vo(),this.name="",this.source=new Io(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new Vt(0,0),this.repeat=new Vt(1,1),this.center=new Vt(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new ne,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Dd).x}get height(){return this.source.getSize(Dd).y}get depth(){return this.source.getSize(Dd).z}get image(){return this.source.data}set image(t){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.normalized=t.normalized,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.mipmapsAutoUpdate=t.mipmapsAutoUpdate,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.renderTarget=t.renderTarget,this.isRenderTargetTexture=t.isRenderTargetTexture,this.isPMREMTexture=t.isPMREMTexture,this.isArrayTexture=t.isArrayTexture,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}setValues(t){for(let e in t){let n=t[e];if(n===void 0){Yt(`Texture.setValues(): parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Yt(`Texture.setValues(): property '${e}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),e||(t.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==Mf)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case Ao:t.x=t.x-Math.floor(t.x);break;case Qi:t.x=t.x<0?0:1;break;case Fc:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case Ao:t.y=t.y-Math.floor(t.y);break;case Qi:t.y=t.y<0?0:1;break;case Fc:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};Zn.DEFAULT_IMAGE=null;Zn.DEFAULT_MAPPING=Mf;Zn.DEFAULT_ANISOTROPY=1;var Qe=class{static{this.prototype.isVector4=!0}constructor(t=0,e=0,n=0,s=1){this.x=t,this.y=e,this.z=n,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,n,s){return this.x=t,this.y=e,this.z=n,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("THREE.Vector4: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*n+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,n,s,r,l=t.elements,c=l[0],h=l[4],d=l[8],u=l[1],p=l[5],m=l[9],x=l[2],g=l[6],_=l[10];if(Math.abs(h-u)<.01&&Math.abs(d-x)<.01&&Math.abs(m-g)<.01){if(Math.abs(h+u)<.1&&Math.abs(d+x)<.1&&Math.abs(m+g)<.1&&Math.abs(c+p+_-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let S=(c+1)/2,y=(p+1)/2,C=(_+1)/2,E=(h+u)/4,v=(d+x)/4,T=(m+g)/4;return S>y&&S>C?S<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(S),s=E/n,r=v/n):y>C?y<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(y),n=E/s,r=T/s):C<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(C),n=v/r,s=T/r),this.set(n,s,r,e),this}let b=Math.sqrt((g-m)*(g-m)+(d-x)*(d-x)+(u-h)*(u-h));return Math.abs(b)<.001&&(b=1),this.x=(g-m)/b,this.y=(d-x)/b,this.z=(u-h)/b,this.w=Math.acos((c+p+_-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=ge(this.x,t.x,e.x),this.y=ge(this.y,t.y,e.y),this.z=ge(this.z,t.z,e.z),this.w=ge(this.w,t.w,e.w),this}clampScalar(t,e){return this.x=ge(this.x,t,e),this.y=ge(this.y,t,e),this.z=ge(this.z,t,e),this.w=ge(this.w,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ge(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this.w=t.w+(e.w-t.w)*n,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Bc=class extends Bi{constructor(t=1,e=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:Vn,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=n.depth,this.scissor=new Qe(0,0,t,e),this.scissorTest=!1,this.viewport=new Qe(0,0,t,e),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new Zn({width:t,height:e,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(t={}){let e={minFilter:Vn,generateMipmaps:!1,flipY:!1,internalFormat:null};t.mapping!==void 0&&(e.mapping=t.mapping),t.wrapS!==void 0&&(e.wrapS=t.wrapS),t.wrapT!==void 0&&(e.wrapT=t.wrapT),t.wrapR!==void 0&&(e.wrapR=t.wrapR),t.magFilter!==void 0&&(e.magFilter=t.magFilter),t.minFilter!==void 0&&(e.minFilter=t.minFilter),t.format!==void 0&&(e.format=t.format),t.type!==void 0&&(e.type=t.type),t.anisotropy!==void 0&&(e.anisotropy=t.anisotropy),t.colorSpace!==void 0&&(e.colorSpace=t.colorSpace),t.flipY!==void 0&&(e.flipY=t.flipY),t.generateMipmaps!==void 0&&(e.generateMipmaps=t.generateMipmaps),t.mipmapsAutoUpdate!==void 0&&(e.mipmapsAutoUpdate=t.mipmapsAutoUpdate),t.internalFormat!==void 0&&(e.internalFormat=t.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(e)}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}set depthTexture(t){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),t!==null&&t.renderTarget===null&&(t.renderTarget=this),this._depthTexture=t}get depthTexture(){return this._depthTexture}setSize(t,e,n=1){if(this.width!==t||this.height!==e||this.depth!==n){this.width=t,this.height=e,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let e=0,n=t.textures.length;e<n;e++){this.textures[e]=t.textures[e].clone(),this.textures[e].isRenderTargetTexture=!0,this.textures[e].renderTarget=this;let s=Object.assign({},t.textures[e].image);this.textures[e].source=new Io(s)}if(this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveColorBuffer=t.resolveColorBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,this.storeMultisampledColorBuffer=t.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=t.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=t.storeMultisampledStencilBuffer,t.depthTexture!==null)if(t.depthTexture.renderTarget===t){let e=t.depthTexture.clone();e.renderTarget=null,this.depthTexture=e}else this.depthTexture=t.depthTexture;else this.depthTexture=null;return this.samples=t.samples,this.multiview=t.multiview,this.useArrayDepthTexture=t.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},xi=class extends Bc{constructor(t=1,e=1,n={}){super(t,e,n),this.isWebGLRenderTarget=!0}},Sa=class extends Zn{constructor(t=null,e=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Bn,this.minFilter=Bn,this.wrapR=Qi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var zc=class extends Zn{constructor(t=null,e=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Bn,this.minFilter=Bn,this.wrapR=Qi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}};var Ve=class i{static{this.prototype.isMatrix4=!0}constructor(t,e,n,s,r,o,a,l,c,h,d,u,p,m,x,g){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c,h,d,u,p,m,x,g)}set(t,e,n,s,r,o,a,l,c,h,d,u,p,m,x,g){let _=this.elements;return _[0]=t,_[4]=e,_[8]=n,_[12]=s,_[1]=r,_[5]=o,_[9]=a,_[13]=l,_[2]=c,_[6]=h,_[10]=d,_[14]=u,_[3]=p,_[7]=m,_[11]=x,_[15]=g,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],e[9]=n[9],e[10]=n[10],e[11]=n[11],e[12]=n[12],e[13]=n[13],e[14]=n[14],e[15]=n[15],this}copyPosition(t){let e=this.elements,n=t.elements;return e[12]=n[12],e[13]=n[13],e[14]=n[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,n){return this.determinantAffine()===0?(t.set(1,0,0),e.set(0,1,0),n.set(0,0,1),this):(t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(t,e,n){return this.set(t.x,e.x,n.x,0,t.y,e.y,n.y,0,t.z,e.z,n.z,0,0,0,0,1),this}extractRotation(t){if(t.determinantAffine()===0)return this.identity();let e=this.elements,n=t.elements,s=1/fo.setFromMatrixColumn(t,0).length(),r=1/fo.setFromMatrixColumn(t,1).length(),o=1/fo.setFromMatrixColumn(t,2).length();return e[0]=n[0]*s,e[1]=n[1]*s,e[2]=n[2]*s,e[3]=0,e[4]=n[4]*r,e[5]=n[5]*r,e[6]=n[6]*r,e[7]=0,e[8]=n[8]*o,e[9]=n[9]*o,e[10]=n[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,n=t.x,s=t.y,r=t.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),d=Math.sin(r);if(t.order==="XYZ"){let u=o*h,p=o*d,m=a*h,x=a*d;e[0]=l*h,e[4]=-l*d,e[8]=c,e[1]=p+m*c,e[5]=u-x*c,e[9]=-a*l,e[2]=x-u*c,e[6]=m+p*c,e[10]=o*l}else if(t.order==="YXZ"){let u=l*h,p=l*d,m=c*h,x=c*d;e[0]=u+x*a,e[4]=m*a-p,e[8]=o*c,e[1]=o*d,e[5]=o*h,e[9]=-a,e[2]=p*a-m,e[6]=x+u*a,e[10]=o*l}else if(t.order==="ZXY"){let u=l*h,p=l*d,m=c*h,x=c*d;e[0]=u-x*a,e[4]=-o*d,e[8]=m+p*a,e[1]=p+m*a,e[5]=o*h,e[9]=x-u*a,e[2]=-o*c,e[6]=a,e[10]=o*l}else if(t.order==="ZYX"){let u=o*h,p=o*d,m=a*h,x=a*d;e[0]=l*h,e[4]=m*c-p,e[8]=u*c+x,e[1]=l*d,e[5]=x*c+u,e[9]=p*c-m,e[2]=-c,e[6]=a*l,e[10]=o*l}else if(t.order==="YZX"){let u=o*l,p=o*c,m=a*l,x=a*c;e[0]=l*h,e[4]=x-u*d,e[8]=m*d+p,e[1]=d,e[5]=o*h,e[9]=-a*h,e[2]=-c*h,e[6]=p*d+m,e[10]=u-x*d}else if(t.order==="XZY"){let u=o*l,p=o*c,m=a*l,x=a*c;e[0]=l*h,e[4]=-d,e[8]=c*h,e[1]=u*d+x,e[5]=o*h,e[9]=p*d-m,e[2]=m*d-p,e[6]=a*h,e[10]=x*d+u}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(Gw,t,Vw)}lookAt(t,e,n){let s=this.elements;return yi.subVectors(t,e),yi.lengthSq()===0&&(yi.z=1),yi.normalize(),Hs.crossVectors(n,yi),Hs.lengthSq()===0&&(Math.abs(n.z)===1?yi.x+=1e-4:yi.z+=1e-4,yi.normalize(),Hs.crossVectors(n,yi)),Hs.normalize(),tc.crossVectors(yi,Hs),s[0]=Hs.x,s[4]=tc.x,s[8]=yi.x,s[1]=Hs.y,s[5]=tc.y,s[9]=yi.y,s[2]=Hs.z,s[6]=tc.z,s[10]=yi.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],d=n[5],u=n[9],p=n[13],m=n[2],x=n[6],g=n[10],_=n[14],b=n[3],S=n[7],y=n[11],C=n[15],E=s[0],v=s[4],T=s[8],F=s[12],L=s[1],D=s[5],B=s[9],G=s[13],N=s[2],W=s[6],q=s[10],V=s[14],lt=s[3],Z=s[7],j=s[11],et=s[15];return r[0]=o*E+a*L+l*N+c*lt,r[4]=o*v+a*D+l*W+c*Z,r[8]=o*T+a*B+l*q+c*j,r[12]=o*F+a*G+l*V+c*et,r[1]=h*E+d*L+u*N+p*lt,r[5]=h*v+d*D+u*W+p*Z,r[9]=h*T+d*B+u*q+p*j,r[13]=h*F+d*G+u*V+p*et,r[2]=m*E+x*L+g*N+_*lt,r[6]=m*v+x*D+g*W+_*Z,r[10]=m*T+x*B+g*q+_*j,r[14]=m*F+x*G+g*V+_*et,r[3]=b*E+S*L+y*N+C*lt,r[7]=b*v+S*D+y*W+C*Z,r[11]=b*T+S*B+y*q+C*j,r[15]=b*F+S*G+y*V+C*et,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[12],o=t[1],a=t[5],l=t[9],c=t[13],h=t[2],d=t[6],u=t[10],p=t[14],m=t[3],x=t[7],g=t[11],_=t[15],b=l*p-c*u,S=a*p-c*d,y=a*u-l*d,C=o*p-c*h,E=o*u-l*h,v=o*d-a*h;return e*(x*b-g*S+_*y)-n*(m*b-g*C+_*E)+s*(m*S-x*C+_*v)-r*(m*y-x*E+g*v)}determinantAffine(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[1],o=t[5],a=t[9],l=t[2],c=t[6],h=t[10];return e*(o*h-a*c)-n*(r*h-a*l)+s*(r*c-o*l)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,n){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=n),this}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],d=t[9],u=t[10],p=t[11],m=t[12],x=t[13],g=t[14],_=t[15],b=e*a-n*o,S=e*l-s*o,y=e*c-r*o,C=n*l-s*a,E=n*c-r*a,v=s*c-r*l,T=h*x-d*m,F=h*g-u*m,L=h*_-p*m,D=d*g-u*x,B=d*_-p*x,G=u*_-p*g,N=b*G-S*B+y*D+C*L-E*F+v*T;if(N===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let W=1/N;return t[0]=(a*G-l*B+c*D)*W,t[1]=(s*B-n*G-r*D)*W,t[2]=(x*v-g*E+_*C)*W,t[3]=(u*E-d*v-p*C)*W,t[4]=(l*L-o*G-c*F)*W,t[5]=(e*G-s*L+r*F)*W,t[6]=(g*y-m*v-_*S)*W,t[7]=(h*v-u*y+p*S)*W,t[8]=(o*B-a*L+c*T)*W,t[9]=(n*L-e*B-r*T)*W,t[10]=(m*E-x*y+_*b)*W,t[11]=(d*y-h*E-p*b)*W,t[12]=(a*F-o*D-l*T)*W,t[13]=(e*D-n*F+s*T)*W,t[14]=(x*S-m*C-g*b)*W,t[15]=(h*C-d*S+u*b)*W,this}scale(t){let e=this.elements,n=t.x,s=t.y,r=t.z;return e[0]*=n,e[4]*=s,e[8]*=r,e[1]*=n,e[5]*=s,e[9]*=r,e[2]*=n,e[6]*=s,e[10]*=r,e[3]*=n,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],n=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,n,s))}makeTranslation(t,e,n){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,n,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),n=Math.sin(t);return this.set(1,0,0,0,0,e,-n,0,0,n,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,0,n,0,0,1,0,0,-n,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,0,n,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let n=Math.cos(e),s=Math.sin(e),r=1-n,o=t.x,a=t.y,l=t.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(t,e,n){return this.set(t,0,0,0,0,e,0,0,0,0,n,0,0,0,0,1),this}makeShear(t,e,n,s,r,o){return this.set(1,n,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,n){let s=this.elements,r=e._x,o=e._y,a=e._z,l=e._w,c=r+r,h=o+o,d=a+a,u=r*c,p=r*h,m=r*d,x=o*h,g=o*d,_=a*d,b=l*c,S=l*h,y=l*d,C=n.x,E=n.y,v=n.z;return s[0]=(1-(x+_))*C,s[1]=(p+y)*C,s[2]=(m-S)*C,s[3]=0,s[4]=(p-y)*E,s[5]=(1-(u+_))*E,s[6]=(g+b)*E,s[7]=0,s[8]=(m+S)*v,s[9]=(g-b)*v,s[10]=(1-(u+x))*v,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,n){let s=this.elements;t.x=s[12],t.y=s[13],t.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),e.identity(),this;let o=fo.set(s[0],s[1],s[2]).length(),a=fo.set(s[4],s[5],s[6]).length(),l=fo.set(s[8],s[9],s[10]).length();r<0&&(o=-o),Fi.copy(this);let c=1/o,h=1/a,d=1/l;return Fi.elements[0]*=c,Fi.elements[1]*=c,Fi.elements[2]*=c,Fi.elements[4]*=h,Fi.elements[5]*=h,Fi.elements[6]*=h,Fi.elements[8]*=d,Fi.elements[9]*=d,Fi.elements[10]*=d,e.setFromRotationMatrix(Fi),n.x=o,n.y=a,n.z=l,this}makePerspective(t,e,n,s,r,o,a=Ai,l=!1){let c=this.elements,h=2*r/(e-t),d=2*r/(n-s),u=(e+t)/(e-t),p=(n+s)/(n-s),m,x;if(l)m=r/(o-r),x=o*r/(o-r);else if(a===Ai)m=-(o+r)/(o-r),x=-2*o*r/(o-r);else if(a===Ro)m=-o/(o-r),x=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=u,c[12]=0,c[1]=0,c[5]=d,c[9]=p,c[13]=0,c[2]=0,c[6]=0,c[10]=m,c[14]=x,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(t,e,n,s,r,o,a=Ai,l=!1){let c=this.elements,h=2/(e-t),d=2/(n-s),u=-(e+t)/(e-t),p=-(n+s)/(n-s),m,x;if(l)m=1/(o-r),x=o/(o-r);else if(a===Ai)m=-2/(o-r),x=-(o+r)/(o-r);else if(a===Ro)m=-1/(o-r),x=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=u,c[1]=0,c[5]=d,c[9]=0,c[13]=p,c[2]=0,c[6]=0,c[10]=m,c[14]=x,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<16;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<16;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t[e+9]=n[9],t[e+10]=n[10],t[e+11]=n[11],t[e+12]=n[12],t[e+13]=n[13],t[e+14]=n[14],t[e+15]=n[15],t}},fo=new H,Fi=new Ve,Gw=new H(0,0,0),Vw=new H(1,1,1),Hs=new H,tc=new H,yi=new H,b0=new Ve,w0=new ai,ts=class i{constructor(t=0,e=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=n,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,n,s=this._order){return this._x=t,this._y=e,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,n=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],d=s[2],u=s[6],p=s[10];switch(e){case"XYZ":this._y=Math.asin(ge(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,p),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(u,c),this._z=0);break;case"YXZ":this._x=Math.asin(-ge(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,p),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-d,r),this._z=0);break;case"ZXY":this._x=Math.asin(ge(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(-d,p),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-ge(d,-1,1)),Math.abs(d)<.9999999?(this._x=Math.atan2(u,p),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(ge(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-d,r)):(this._x=0,this._y=Math.atan2(a,p));break;case"XZY":this._z=Math.asin(-ge(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(u,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,p),this._y=0);break;default:Yt("Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,n===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,n){return b0.makeRotationFromQuaternion(t),this.setFromRotationMatrix(b0,e,n)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return w0.setFromEuler(this),this.setFromQuaternion(w0,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};ts.DEFAULT_ORDER="XYZ";var Lo=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},Ww=0,S0=new H,po=new ai,ms=new Ve,ec=new H,ha=new H,$w=new H,Xw=new ai,M0=new H(1,0,0),E0=new H(0,1,0),T0=new H(0,0,1),A0={type:"added"},qw={type:"removed"},mo={type:"childadded",child:null},Nd={type:"childremoved",child:null},Rn=class i extends Bi{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Ww++}),this.uuid=Vo(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let t=new H,e=new ts,n=new ai,s=new H(1,1,1);function r(){n.setFromEuler(e,!1)}function o(){e.setFromQuaternion(n,void 0,!1)}e._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Ve},normalMatrix:{value:new ne}}),this.matrix=new Ve,this.matrixWorld=new Ve,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Lo,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return po.setFromAxisAngle(t,e),this.quaternion.multiply(po),this}rotateOnWorldAxis(t,e){return po.setFromAxisAngle(t,e),this.quaternion.premultiply(po),this}rotateX(t){return this.rotateOnAxis(M0,t)}rotateY(t){return this.rotateOnAxis(E0,t)}rotateZ(t){return this.rotateOnAxis(T0,t)}translateOnAxis(t,e){return S0.copy(t).applyQuaternion(this.quaternion),this.position.add(S0.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(M0,t)}translateY(t){return this.translateOnAxis(E0,t)}translateZ(t){return this.translateOnAxis(T0,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(ms.copy(this.matrixWorld).invert())}lookAt(t,e,n){t.isVector3?ec.copy(t):ec.set(t,e,n);let s=this.parent;this.updateWorldMatrix(!0,!1),ha.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?ms.lookAt(ha,ec,this.up):ms.lookAt(ec,ha,this.up),this.quaternion.setFromRotationMatrix(ms),s&&(ms.extractRotation(s.matrixWorld),po.setFromRotationMatrix(ms),this.quaternion.premultiply(po.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(te("Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(A0),mo.child=t,this.dispatchEvent(mo),mo.child=null):te("Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(qw),Nd.child=t,this.dispatchEvent(Nd),Nd.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),ms.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),ms.multiply(t.parent.matrixWorld)),t.applyMatrix4(ms),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(A0),mo.child=t,this.dispatchEvent(mo),mo.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,n=[]){this[t]===e&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,n);return n}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ha,t,$w),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ha,Xw,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(t){t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let t=this.pivot;if(t!==null){let e=t.x,n=t.y,s=t.z,r=this.matrix.elements;r[12]+=e-r[0]*e-r[4]*n-r[8]*s,r[13]+=n-r[1]*e-r[5]*n-r[9]*s,r[14]+=s-r[2]*e-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].updateMatrixWorld(t)}updateWorldMatrix(t,e,n=!1){let s=this.parent;if(t===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),e===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(t){let e=t===void 0||typeof t=="string",n={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(t),s.indirectTexture=this._indirectTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(t)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let d=l[c];r(t.shapes,d)}else r(t.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(t.materials,this.material[l]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(t.animations,l))}}if(e){let a=o(t.geometries),l=o(t.materials),c=o(t.textures),h=o(t.images),d=o(t.shapes),u=o(t.skeletons),p=o(t.animations),m=o(t.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),d.length>0&&(n.shapes=d),u.length>0&&(n.skeletons=u),p.length>0&&(n.animations=p),m.length>0&&(n.nodes=m)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.pivot=t.pivot!==null?t.pivot.clone():null,this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.static=t.static,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let n=0;n<t.children.length;n++){let s=t.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Rn.DEFAULT_UP=new H(0,1,0);Rn.DEFAULT_MATRIX_AUTO_UPDATE=!0;Rn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var un=class extends Rn{constructor(){super(),this.isGroup=!0,this.type="Group"}},Yw={type:"move"},Do=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new un,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new un,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new H,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new H),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new un,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new H,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new H,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let n of t.hand.values())this._getHandJoint(e,n)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(c&&t.hand){o=!0;for(let x of t.hand.values()){let g=e.getJointPose(x,n),_=this._getHandJoint(c,x);g!==null&&(_.matrix.fromArray(g.transform.matrix),_.matrix.decompose(_.position,_.quaternion,_.scale),_.matrixWorldNeedsUpdate=!0,_.jointRadius=g.radius),_.visible=g!==null}let h=c.joints["index-finger-tip"],d=c.joints["thumb-tip"],u=h.position.distanceTo(d.position),p=.02,m=.005;c.inputState.pinching&&u>p+m?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!c.inputState.pinching&&u<=p-m&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else l!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:t,target:this})));a!==null&&(s=e.getPose(t.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(Yw)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let n=new un;n.matrixAutoUpdate=!1,n.visible=!1,t.joints[e.jointName]=n,t.add(n)}return t.joints[e.jointName]}},O_={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Gs={h:0,s:0,l:0},nc={h:0,s:0,l:0};function Ud(i,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?i+(t-i)*6*e:e<1/2?t:e<2/3?i+(t-i)*6*(2/3-e):i}var Zt=class{constructor(t,e,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,n)}set(t,e,n){if(e===void 0&&n===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,n);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=sn){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,xe.colorSpaceToWorking(this,e),this}setRGB(t,e,n,s=xe.workingColorSpace){return this.r=t,this.g=e,this.b=n,xe.colorSpaceToWorking(this,s),this}setHSL(t,e,n,s=xe.workingColorSpace){if(t=Of(t,1),e=ge(e,0,1),n=ge(n,0,1),e===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+e):n+e-n*e,o=2*n-r;this.r=Ud(o,r,t+1/3),this.g=Ud(o,r,t),this.b=Ud(o,r,t-1/3)}return xe.colorSpaceToWorking(this,s),this}setStyle(t,e=sn){function n(r){r!==void 0&&parseFloat(r)<1&&Yt("Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,e);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:Yt("Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);Yt("Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=sn){let n=O_[t.toLowerCase()];return n!==void 0?this.setHex(n,e):Yt("Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=xs(t.r),this.g=xs(t.g),this.b=xs(t.b),this}copyLinearToSRGB(t){return this.r=Eo(t.r),this.g=Eo(t.g),this.b=Eo(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=sn){return xe.workingToColorSpace(Yn.copy(this),t),Math.round(ge(Yn.r*255,0,255))*65536+Math.round(ge(Yn.g*255,0,255))*256+Math.round(ge(Yn.b*255,0,255))}getHexString(t=sn){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=xe.workingColorSpace){xe.workingToColorSpace(Yn.copy(this),e);let n=Yn.r,s=Yn.g,r=Yn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let d=o-a;switch(c=h<=.5?d/(o+a):d/(2-o-a),o){case n:l=(s-r)/d+(s<r?6:0);break;case s:l=(r-n)/d+2;break;case r:l=(n-s)/d+4;break}l/=6}return t.h=l,t.s=c,t.l=h,t}getRGB(t,e=xe.workingColorSpace){return xe.workingToColorSpace(Yn.copy(this),e),t.r=Yn.r,t.g=Yn.g,t.b=Yn.b,t}getStyle(t=sn){xe.workingToColorSpace(Yn.copy(this),t);let e=Yn.r,n=Yn.g,s=Yn.b;return t!==sn?`color(${t} ${e.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(t,e,n){return this.getHSL(Gs),this.setHSL(Gs.h+t,Gs.s+e,Gs.l+n)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,n){return this.r=t.r+(e.r-t.r)*n,this.g=t.g+(e.g-t.g)*n,this.b=t.b+(e.b-t.b)*n,this}lerpHSL(t,e){this.getHSL(Gs),t.getHSL(nc);let n=ya(Gs.h,nc.h,e),s=ya(Gs.s,nc.s,e),r=ya(Gs.l,nc.l,e);return this.setHSL(n,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,n=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*n+r[6]*s,this.g=r[1]*e+r[4]*n+r[7]*s,this.b=r[2]*e+r[5]*n+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},Yn=new Zt;Zt.NAMES=O_;var Ma=class i{constructor(t,e=1,n=1e3){this.isFog=!0,this.name="",this.color=new Zt(t),this.near=e,this.far=n}clone(){return new i(this.color,this.near,this.far)}toJSON(){return{type:"Fog",name:this.name,color:this.color.getHex(),near:this.near,far:this.far}}},Ea=class extends Rn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new ts,this.environmentIntensity=1,this.environmentRotation=new ts,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),this.background=t.background!==null?t.background.clone():null,this.environment=t.environment!==null?t.environment.clone():null,this.fog=t.fog!==null?t.fog.clone():null,this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),this.overrideMaterial=t.overrideMaterial!==null?t.overrideMaterial.clone():null,this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),e.object.backgroundBlurriness=this.backgroundBlurriness,e.object.backgroundIntensity=this.backgroundIntensity,e.object.backgroundRotation=this.backgroundRotation.toArray(),e.object.environmentIntensity=this.environmentIntensity,e.object.environmentRotation=this.environmentRotation.toArray(),e}},Oi=new H,gs=new H,Fd=new H,_s=new H,go=new H,_o=new H,R0=new H,Od=new H,kd=new H,Bd=new H,zd=new Qe,Hd=new Qe,Gd=new Qe,Xs=class i{constructor(t=new H,e=new H,n=new H){this.a=t,this.b=e,this.c=n}static getNormal(t,e,n,s){s.subVectors(n,e),Oi.subVectors(t,e),s.cross(Oi);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,n,s,r){Oi.subVectors(s,e),gs.subVectors(n,e),Fd.subVectors(t,e);let o=Oi.dot(Oi),a=Oi.dot(gs),l=Oi.dot(Fd),c=gs.dot(gs),h=gs.dot(Fd),d=o*c-a*a;if(d===0)return r.set(0,0,0),null;let u=1/d,p=(c*l-a*h)*u,m=(o*h-a*l)*u;return r.set(1-p-m,m,p)}static containsPoint(t,e,n,s){return this.getBarycoord(t,e,n,s,_s)===null?!1:_s.x>=0&&_s.y>=0&&_s.x+_s.y<=1}static getInterpolation(t,e,n,s,r,o,a,l){return this.getBarycoord(t,e,n,s,_s)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,_s.x),l.addScaledVector(o,_s.y),l.addScaledVector(a,_s.z),l)}static getInterpolatedAttribute(t,e,n,s,r,o){return zd.setScalar(0),Hd.setScalar(0),Gd.setScalar(0),zd.fromBufferAttribute(t,e),Hd.fromBufferAttribute(t,n),Gd.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(zd,r.x),o.addScaledVector(Hd,r.y),o.addScaledVector(Gd,r.z),o}static isFrontFacing(t,e,n,s){return Oi.subVectors(n,e),gs.subVectors(t,e),Oi.cross(gs).dot(s)<0}set(t,e,n){return this.a.copy(t),this.b.copy(e),this.c.copy(n),this}setFromPointsAndIndices(t,e,n,s){return this.a.copy(t[e]),this.b.copy(t[n]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,n,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,n),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return Oi.subVectors(this.c,this.b),gs.subVectors(this.a,this.b),Oi.cross(gs).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return i.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return i.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,n,s,r){return i.getInterpolation(t,this.a,this.b,this.c,e,n,s,r)}containsPoint(t){return i.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return i.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let n=this.a,s=this.b,r=this.c,o,a;go.subVectors(s,n),_o.subVectors(r,n),Od.subVectors(t,n);let l=go.dot(Od),c=_o.dot(Od);if(l<=0&&c<=0)return e.copy(n);kd.subVectors(t,s);let h=go.dot(kd),d=_o.dot(kd);if(h>=0&&d<=h)return e.copy(s);let u=l*d-h*c;if(u<=0&&l>=0&&h<=0&&l-h>0)return o=l/(l-h),e.copy(n).addScaledVector(go,o);Bd.subVectors(t,r);let p=go.dot(Bd),m=_o.dot(Bd);if(m>=0&&p<=m)return e.copy(r);let x=p*c-l*m;if(x<=0&&c>=0&&m<=0)return a=c/(c-m),e.copy(n).addScaledVector(_o,a);let g=h*m-p*d;if(g<=0&&d-h>=0&&p-m>=0)return R0.subVectors(r,s),a=(d-h)/(d-h+(p-m)),e.copy(s).addScaledVector(R0,a);let _=1/(g+x+u);return o=x*_,a=u*_,e.copy(n).addScaledVector(go,o).addScaledVector(_o,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},qs=class{constructor(t=new H(1/0,1/0,1/0),e=new H(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e+=3)this.expandByPoint(ki.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,n=t.count;e<n;e++)this.expandByPoint(ki.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let n=ki.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(n),this.max.copy(t).add(n),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let n=t.geometry;if(n!==void 0){let r=n.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0&&t.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,ki):ki.fromBufferAttribute(r,o),ki.applyMatrix4(t.matrixWorld),this.expandByPoint(ki);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),ic.copy(t.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),ic.copy(n.boundingBox)),ic.applyMatrix4(t.matrixWorld),this.union(ic)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,ki),ki.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,n;return t.normal.x>0?(e=t.normal.x*this.min.x,n=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,n=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,n+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,n+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,n+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,n+=t.normal.z*this.min.z),e<=-t.constant&&n>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(ua),sc.subVectors(this.max,ua),yo.subVectors(t.a,ua),vo.subVectors(t.b,ua),xo.subVectors(t.c,ua),Vs.subVectors(vo,yo),Ws.subVectors(xo,vo),wr.subVectors(yo,xo);let e=[0,-Vs.z,Vs.y,0,-Ws.z,Ws.y,0,-wr.z,wr.y,Vs.z,0,-Vs.x,Ws.z,0,-Ws.x,wr.z,0,-wr.x,-Vs.y,Vs.x,0,-Ws.y,Ws.x,0,-wr.y,wr.x,0];return!Vd(e,yo,vo,xo,sc)||(e=[1,0,0,0,1,0,0,0,1],!Vd(e,yo,vo,xo,sc))?!1:(rc.crossVectors(Vs,Ws),e=[rc.x,rc.y,rc.z],Vd(e,yo,vo,xo,sc))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,ki).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(ki).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(ys[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),ys[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),ys[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),ys[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),ys[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),ys[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),ys[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),ys[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(ys),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(t){return this.min.fromArray(t.min),this.max.fromArray(t.max),this}},ys=[new H,new H,new H,new H,new H,new H,new H,new H],ki=new H,ic=new qs,yo=new H,vo=new H,xo=new H,Vs=new H,Ws=new H,wr=new H,ua=new H,sc=new H,rc=new H,Sr=new H;function Vd(i,t,e,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Sr.fromArray(i,r);let a=s.x*Math.abs(Sr.x)+s.y*Math.abs(Sr.y)+s.z*Math.abs(Sr.z),l=t.dot(Sr),c=e.dot(Sr),h=n.dot(Sr);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var Sn=new H,oc=new Vt,Zw=0,Ue=class extends Bi{constructor(t,e,n=!1){if(super(),Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:Zw++}),this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=n,this.usage=P_,this.updateRanges=[],this.gpuType=Jn,this.version=0,this._normalizationScale=t!==void 0?Bf(t):void 0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this._normalizationScale=t._normalizationScale,this}copyAt(t,e,n){t*=this.itemSize,n*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[n+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,n=this.count;e<n;e++)oc.fromBufferAttribute(this,e),oc.applyMatrix3(t),this.setXY(e,oc.x,oc.y);else if(this.itemSize===3)for(let e=0,n=this.count;e<n;e++)Sn.fromBufferAttribute(this,e),Sn.applyMatrix3(t),this.setXYZ(e,Sn.x,Sn.y,Sn.z);return this}applyMatrix4(t){for(let e=0,n=this.count;e<n;e++)Sn.fromBufferAttribute(this,e),Sn.applyMatrix4(t),this.setXYZ(e,Sn.x,Sn.y,Sn.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)Sn.fromBufferAttribute(this,e),Sn.applyNormalMatrix(t),this.setXYZ(e,Sn.x,Sn.y,Sn.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)Sn.fromBufferAttribute(this,e),Sn.transformDirection(t),this.setXYZ(e,Sn.x,Sn.y,Sn.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let n=this.array[t*this.itemSize+e];return this.normalized&&(n=this._denormalize(n)),n}setComponent(t,e,n){return this.normalized&&(n=this._normalize(n)),this.array[t*this.itemSize+e]=n,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=this._denormalize(e)),e}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=this._denormalize(e)),e}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=this._denormalize(e)),e}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=this._denormalize(e)),e}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,n){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n)),this.array[t+0]=e,this.array[t+1]=n,this}setXYZ(t,e,n,s){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return t.name=this.name,t.usage=this.usage,t.gpuType=this.gpuType,t}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):U_(t,this.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):F_(t,this.array)}};var Ta=class extends Ue{constructor(t,e,n){super(new Uint16Array(t),e,n)}};var Aa=class extends Ue{constructor(t,e,n){super(new Uint32Array(t),e,n)}};var Ee=class extends Ue{constructor(t,e,n){super(new Float32Array(t),e,n)}},Kw=new qs,da=new H,Wd=new H,Ys=class{constructor(t=new H,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let n=this.center;e!==void 0?n.copy(e):Kw.setFromPoints(t).getCenter(n);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,n.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let n=this.center.distanceToSquared(t);return e.copy(t),n>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;da.subVectors(t,this.center);let e=da.lengthSq();if(e>this.radius*this.radius){let n=Math.sqrt(e),s=(n-this.radius)*.5;this.center.addScaledVector(da,s/n),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(Wd.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(da.copy(t.center).add(Wd)),this.expandByPoint(da.copy(t.center).sub(Wd))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(t){return this.radius=t.radius,this.center.fromArray(t.center),this}},Jw=0,Ti=new Ve,$d=new Rn,bo=new H,vi=new qs,fa=new qs,kn=new H,Fe=class i extends Bi{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:Jw++}),this.uuid=Vo(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(ww(t)?Aa:Ta)(t,1):this.index=t,this}setIndirect(t,e=0){return this.indirect=t,this.indirectOffset=e,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,n=0){this.groups.push({start:t,count:e,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new ne().getNormalMatrix(t);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(t){return Ti.makeRotationFromQuaternion(t),this.applyMatrix4(Ti),this}rotateX(t){return Ti.makeRotationX(t),this.applyMatrix4(Ti),this}rotateY(t){return Ti.makeRotationY(t),this.applyMatrix4(Ti),this}rotateZ(t){return Ti.makeRotationZ(t),this.applyMatrix4(Ti),this}translate(t,e,n){return Ti.makeTranslation(t,e,n),this.applyMatrix4(Ti),this}scale(t,e,n){return Ti.makeScale(t,e,n),this.applyMatrix4(Ti),this}lookAt(t){return $d.lookAt(t),$d.updateMatrix(),this.applyMatrix4($d.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(bo).negate(),this.translate(bo.x,bo.y,bo.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let n=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Ee(n,3))}else{let n=Math.min(t.length,e.count);for(let s=0;s<n;s++){let r=t[s];e.setXYZ(s,r.x,r.y,r.z||0)}t.length>e.count&&Yt("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new qs);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){te("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new H(-1/0,-1/0,-1/0),new H(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let n=0,s=e.length;n<s;n++){let r=e[n];vi.setFromBufferAttribute(r),this.morphTargetsRelative?(kn.addVectors(this.boundingBox.min,vi.min),this.boundingBox.expandByPoint(kn),kn.addVectors(this.boundingBox.max,vi.max),this.boundingBox.expandByPoint(kn)):(this.boundingBox.expandByPoint(vi.min),this.boundingBox.expandByPoint(vi.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&te('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new Ys);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){te("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new H,1/0);return}if(t){let n=this.boundingSphere.center;if(vi.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];fa.setFromBufferAttribute(a),this.morphTargetsRelative?(kn.addVectors(vi.min,fa.min),vi.expandByPoint(kn),kn.addVectors(vi.max,fa.max),vi.expandByPoint(kn)):(vi.expandByPoint(fa.min),vi.expandByPoint(fa.max))}vi.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)kn.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared(kn));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)kn.fromBufferAttribute(a,c),l&&(bo.fromBufferAttribute(t,c),kn.add(bo)),s=Math.max(s,n.distanceToSquared(kn))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&te('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){te("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=e.position,s=e.normal,r=e.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ue(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let F=0;F<n.count;F++)a[F]=new H,l[F]=new H;let h=new H,d=new H,u=new H,p=new Vt,m=new Vt,x=new Vt,g=new H,_=new H;function b(F,L,D){c[F]=c[L]=c[D]=1,h.fromBufferAttribute(n,F),d.fromBufferAttribute(n,L),u.fromBufferAttribute(n,D),p.fromBufferAttribute(r,F),m.fromBufferAttribute(r,L),x.fromBufferAttribute(r,D),d.sub(h),u.sub(h),m.sub(p),x.sub(p);let B=1/(m.x*x.y-x.x*m.y);isFinite(B)&&(g.copy(d).multiplyScalar(x.y).addScaledVector(u,-m.y).multiplyScalar(B),_.copy(u).multiplyScalar(m.x).addScaledVector(d,-x.x).multiplyScalar(B),a[F].add(g),a[L].add(g),a[D].add(g),l[F].add(_),l[L].add(_),l[D].add(_))}let S=this.groups;S.length===0&&(S=[{start:0,count:t.count}]);for(let F=0,L=S.length;F<L;++F){let D=S[F],B=D.start,G=D.count;for(let N=B,W=B+G;N<W;N+=3)b(t.getX(N+0),t.getX(N+1),t.getX(N+2))}let y=new H,C=new H,E=new H,v=new H;function T(F){E.fromBufferAttribute(s,F),v.copy(E);let L=a[F];y.copy(L),y.sub(E.multiplyScalar(E.dot(L))).normalize(),C.crossVectors(v,L);let B=C.dot(l[F])<0?-1:1;o.setXYZW(F,y.x,y.y,y.z,B)}for(let F=0,L=n.count;F<L;++F)c[F]&&T(F);this._transformed=!0}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==e.count)n=new Ue(new Float32Array(e.count*3),3),this.setAttribute("normal",n);else for(let u=0,p=n.count;u<p;u++)n.setXYZ(u,0,0,0);let s=new H,r=new H,o=new H,a=new H,l=new H,c=new H,h=new H,d=new H;if(t)for(let u=0,p=t.count;u<p;u+=3){let m=t.getX(u+0),x=t.getX(u+1),g=t.getX(u+2);s.fromBufferAttribute(e,m),r.fromBufferAttribute(e,x),o.fromBufferAttribute(e,g),h.subVectors(o,r),d.subVectors(s,r),h.cross(d),a.fromBufferAttribute(n,m),l.fromBufferAttribute(n,x),c.fromBufferAttribute(n,g),a.add(h),l.add(h),c.add(h),n.setXYZ(m,a.x,a.y,a.z),n.setXYZ(x,l.x,l.y,l.z),n.setXYZ(g,c.x,c.y,c.z)}else for(let u=0,p=e.count;u<p;u+=3)s.fromBufferAttribute(e,u+0),r.fromBufferAttribute(e,u+1),o.fromBufferAttribute(e,u+2),h.subVectors(o,r),d.subVectors(s,r),h.cross(d),n.setXYZ(u+0,h.x,h.y,h.z),n.setXYZ(u+1,h.x,h.y,h.z),n.setXYZ(u+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,n=t.count;e<n;e++)kn.fromBufferAttribute(t,e),kn.normalize(),t.setXYZ(e,kn.x,kn.y,kn.z)}toNonIndexed(){function t(a,l){let c=a.array,h=a.itemSize,d=a.normalized,u=new c.constructor(l.length*h),p=0,m=0;for(let x=0,g=l.length;x<g;x++){a.isInterleavedBufferAttribute?p=l[x]*a.data.stride+a.offset:p=l[x]*h;for(let _=0;_<h;_++)u[m++]=c[p++]}return new Ue(u,h,d)}if(this.index===null)return Yt("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=t(l,n);e.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,d=c.length;h<d;h++){let u=c[h],p=t(u,n);l.push(p)}e.morphAttributes[a]=l}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];e.addGroup(c.start,c.count,c.materialIndex)}return e}toJSON(){let t={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,t.name=this.name,Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(t[c]=l[c]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let n=this.attributes;for(let l in n){let c=n[l];t.data.attributes[l]=c.toJSON(t.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let d=0,u=c.length;d<u;d++){let p=c[d];h.push(p.toJSON(t.data))}h.length>0&&(s[l]=h,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere=a.toJSON()),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let n=t.index;n!==null&&this.setIndex(n.clone());let s=t.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(e))}let r=t.morphAttributes;for(let c in r){let h=[],d=r[c];for(let u=0,p=d.length;u<p;u++)h.push(d[u].clone(e));this.morphAttributes[c]=h}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let c=0,h=o.length;c<h;c++){let d=o[c];this.addGroup(d.start,d.count,d.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=t.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this._transformed=t._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var Xd=new H,jw=new H,Qw=new ne,Gn=class{constructor(t=new H(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,n,s){return this.normal.set(t,e,n),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,n){let s=Xd.subVectors(n,e).cross(jw.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e,n=!0){let s=t.delta(Xd),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let o=-(t.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:e.copy(t.start).addScaledVector(s,o)}intersectsLine(t){let e=this.distanceToPoint(t.start),n=this.distanceToPoint(t.end);return e<0&&n>0||n<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let n=e||Qw.getNormalMatrix(t),s=this.coplanarPoint(Xd).applyMatrix4(t),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(t){return this.normal.fromArray(t.normal),this.constant=t.constant,this}},tS=0,zi=class extends Bi{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:tS++}),this.uuid=Vo(),this.name="",this.type="Material",this.blending=zo,this.side=ar,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=mf,this.blendDst=gf,this.blendEquation=Lr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Zt(0,0,0),this.blendAlpha=0,this.depthFunc=To,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=M_,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Rc,this.stencilZFail=Rc,this.stencilZPass=Rc,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let n=t[e];if(n===void 0){Yt(`Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Yt(`Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(t).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(t).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(t).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(t).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(t).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(t).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(t).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(t).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(t,e){if(t.uuid!==void 0&&(this.uuid=t.uuid),t.name!==void 0&&(this.name=t.name),t.color!==void 0&&this.color!==void 0&&this.color.setHex(t.color),t.roughness!==void 0&&(this.roughness=t.roughness),t.metalness!==void 0&&(this.metalness=t.metalness),t.sheen!==void 0&&(this.sheen=t.sheen),t.sheenColor!==void 0&&(this.sheenColor=new Zt().setHex(t.sheenColor)),t.sheenRoughness!==void 0&&(this.sheenRoughness=t.sheenRoughness),t.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(t.emissive),t.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(t.specular),t.specularIntensity!==void 0&&(this.specularIntensity=t.specularIntensity),t.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(t.specularColor),t.shininess!==void 0&&(this.shininess=t.shininess),t.clearcoat!==void 0&&(this.clearcoat=t.clearcoat),t.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=t.clearcoatRoughness),t.diffuseRoughness!==void 0&&(this.diffuseRoughness=t.diffuseRoughness),t.dispersion!==void 0&&(this.dispersion=t.dispersion),t.retroreflectivity!==void 0&&(this.retroreflectivity=t.retroreflectivity),t.iridescence!==void 0&&(this.iridescence=t.iridescence),t.iridescenceIOR!==void 0&&(this.iridescenceIOR=t.iridescenceIOR),t.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessMinimum),t.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=t.iridescenceThicknessMaximum),t.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=t.iridescenceThicknessRange[1]),t.transmission!==void 0&&(this.transmission=t.transmission),t.thickness!==void 0&&(this.thickness=t.thickness),t.attenuationDistance!==void 0&&(this.attenuationDistance=t.attenuationDistance),t.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(t.attenuationColor),t.anisotropy!==void 0&&(this.anisotropy=t.anisotropy),t.anisotropyRotation!==void 0&&(this.anisotropyRotation=t.anisotropyRotation),t.fog!==void 0&&(this.fog=t.fog),t.flatShading!==void 0&&(this.flatShading=t.flatShading),t.blending!==void 0&&(this.blending=t.blending),t.combine!==void 0&&(this.combine=t.combine),t.side!==void 0&&(this.side=t.side),t.shadowSide!==void 0&&(this.shadowSide=t.shadowSide),t.opacity!==void 0&&(this.opacity=t.opacity),t.transparent!==void 0&&(this.transparent=t.transparent),t.alphaTest!==void 0&&(this.alphaTest=t.alphaTest),t.alphaHash!==void 0&&(this.alphaHash=t.alphaHash),t.depthFunc!==void 0&&(this.depthFunc=t.depthFunc),t.depthTest!==void 0&&(this.depthTest=t.depthTest),t.depthWrite!==void 0&&(this.depthWrite=t.depthWrite),t.colorWrite!==void 0&&(this.colorWrite=t.colorWrite),t.clippingPlanes!==void 0&&(this.clippingPlanes=t.clippingPlanes.map(n=>new Gn().fromJSON(n))),t.clipIntersection!==void 0&&(this.clipIntersection=t.clipIntersection),t.clipShadows!==void 0&&(this.clipShadows=t.clipShadows),t.depthPacking!==void 0&&(this.depthPacking=t.depthPacking),t.blendSrc!==void 0&&(this.blendSrc=t.blendSrc),t.blendDst!==void 0&&(this.blendDst=t.blendDst),t.blendEquation!==void 0&&(this.blendEquation=t.blendEquation),t.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=t.blendSrcAlpha),t.blendDstAlpha!==void 0&&(this.blendDstAlpha=t.blendDstAlpha),t.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=t.blendEquationAlpha),t.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(t.blendColor),t.blendAlpha!==void 0&&(this.blendAlpha=t.blendAlpha),t.stencilWriteMask!==void 0&&(this.stencilWriteMask=t.stencilWriteMask),t.stencilFunc!==void 0&&(this.stencilFunc=t.stencilFunc),t.stencilRef!==void 0&&(this.stencilRef=t.stencilRef),t.stencilFuncMask!==void 0&&(this.stencilFuncMask=t.stencilFuncMask),t.stencilFail!==void 0&&(this.stencilFail=t.stencilFail),t.stencilZFail!==void 0&&(this.stencilZFail=t.stencilZFail),t.stencilZPass!==void 0&&(this.stencilZPass=t.stencilZPass),t.stencilWrite!==void 0&&(this.stencilWrite=t.stencilWrite),t.wireframe!==void 0&&(this.wireframe=t.wireframe),t.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=t.wireframeLinewidth),t.wireframeLinecap!==void 0&&(this.wireframeLinecap=t.wireframeLinecap),t.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=t.wireframeLinejoin),t.rotation!==void 0&&(this.rotation=t.rotation),t.linewidth!==void 0&&(this.linewidth=t.linewidth),t.linecap!==void 0&&(this.linecap=t.linecap),t.linejoin!==void 0&&(this.linejoin=t.linejoin),t.dashSize!==void 0&&(this.dashSize=t.dashSize),t.gapSize!==void 0&&(this.gapSize=t.gapSize),t.scale!==void 0&&(this.scale=t.scale),t.polygonOffset!==void 0&&(this.polygonOffset=t.polygonOffset),t.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=t.polygonOffsetFactor),t.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=t.polygonOffsetUnits),t.dithering!==void 0&&(this.dithering=t.dithering),t.alphaToCoverage!==void 0&&(this.alphaToCoverage=t.alphaToCoverage),t.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=t.premultipliedAlpha),t.forceSinglePass!==void 0&&(this.forceSinglePass=t.forceSinglePass),t.allowOverride!==void 0&&(this.allowOverride=t.allowOverride),t.visible!==void 0&&(this.visible=t.visible),t.toneMapped!==void 0&&(this.toneMapped=t.toneMapped),t.userData!==void 0&&(this.userData=t.userData),t.vertexColors!==void 0&&(typeof t.vertexColors=="number"?this.vertexColors=t.vertexColors>0:this.vertexColors=t.vertexColors),t.size!==void 0&&(this.size=t.size),t.sizeAttenuation!==void 0&&(this.sizeAttenuation=t.sizeAttenuation),t.map!==void 0&&(this.map=e[t.map]||null),t.matcap!==void 0&&(this.matcap=e[t.matcap]||null),t.alphaMap!==void 0&&(this.alphaMap=e[t.alphaMap]||null),t.bumpMap!==void 0&&(this.bumpMap=e[t.bumpMap]||null),t.bumpScale!==void 0&&(this.bumpScale=t.bumpScale),t.normalMap!==void 0&&(this.normalMap=e[t.normalMap]||null),t.normalMapType!==void 0&&(this.normalMapType=t.normalMapType),t.normalScale!==void 0){let n=t.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new Vt().fromArray(n)}return t.displacementMap!==void 0&&(this.displacementMap=e[t.displacementMap]||null),t.displacementScale!==void 0&&(this.displacementScale=t.displacementScale),t.displacementBias!==void 0&&(this.displacementBias=t.displacementBias),t.roughnessMap!==void 0&&(this.roughnessMap=e[t.roughnessMap]||null),t.metalnessMap!==void 0&&(this.metalnessMap=e[t.metalnessMap]||null),t.emissiveMap!==void 0&&(this.emissiveMap=e[t.emissiveMap]||null),t.emissiveIntensity!==void 0&&(this.emissiveIntensity=t.emissiveIntensity),t.specularMap!==void 0&&(this.specularMap=e[t.specularMap]||null),t.specularIntensityMap!==void 0&&(this.specularIntensityMap=e[t.specularIntensityMap]||null),t.specularColorMap!==void 0&&(this.specularColorMap=e[t.specularColorMap]||null),t.envMap!==void 0&&(this.envMap=e[t.envMap]||null),t.envMapRotation!==void 0&&this.envMapRotation.fromArray(t.envMapRotation),t.envMapIntensity!==void 0&&(this.envMapIntensity=t.envMapIntensity),t.reflectivity!==void 0&&(this.reflectivity=t.reflectivity),t.refractionRatio!==void 0&&(this.refractionRatio=t.refractionRatio),t.lightMap!==void 0&&(this.lightMap=e[t.lightMap]||null),t.lightMapIntensity!==void 0&&(this.lightMapIntensity=t.lightMapIntensity),t.aoMap!==void 0&&(this.aoMap=e[t.aoMap]||null),t.aoMapIntensity!==void 0&&(this.aoMapIntensity=t.aoMapIntensity),t.gradientMap!==void 0&&(this.gradientMap=e[t.gradientMap]||null),t.clearcoatMap!==void 0&&(this.clearcoatMap=e[t.clearcoatMap]||null),t.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=e[t.clearcoatRoughnessMap]||null),t.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=e[t.clearcoatNormalMap]||null),t.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new Vt().fromArray(t.clearcoatNormalScale)),t.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=e[t.diffuseRoughnessMap]||null),t.iridescenceMap!==void 0&&(this.iridescenceMap=e[t.iridescenceMap]||null),t.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=e[t.iridescenceThicknessMap]||null),t.transmissionMap!==void 0&&(this.transmissionMap=e[t.transmissionMap]||null),t.thicknessMap!==void 0&&(this.thicknessMap=e[t.thicknessMap]||null),t.anisotropyMap!==void 0&&(this.anisotropyMap=e[t.anisotropyMap]||null),t.sheenColorMap!==void 0&&(this.sheenColorMap=e[t.sheenColorMap]||null),t.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=e[t.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,n=null;if(e!==null){let s=e.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=e[r].clone()}return this.clippingPlanes=n,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.allowOverride=t.allowOverride,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}};var vs=new H,qd=new H,ac=new H,lc=new H,ws=class{constructor(t=new H,e=new H(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,vs)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let n=e.dot(this.direction);return n<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=vs.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(vs.copy(this.origin).addScaledVector(this.direction,e),vs.distanceToSquared(t))}distanceSqToSegment(t,e,n,s){qd.copy(t).add(e).multiplyScalar(.5),ac.copy(e).sub(t).normalize(),lc.copy(this.origin).sub(qd);let r=t.distanceTo(e)*.5,o=-this.direction.dot(ac),a=lc.dot(this.direction),l=-lc.dot(ac),c=lc.lengthSq(),h=Math.abs(1-o*o),d,u,p,m;if(h>0)if(d=o*l-a,u=o*a-l,m=r*h,d>=0)if(u>=-m)if(u<=m){let x=1/h;d*=x,u*=x,p=d*(d+o*u+2*a)+u*(o*d+u+2*l)+c}else u=r,d=Math.max(0,-(o*u+a)),p=-d*d+u*(u+2*l)+c;else u=-r,d=Math.max(0,-(o*u+a)),p=-d*d+u*(u+2*l)+c;else u<=-m?(d=Math.max(0,-(-o*r+a)),u=d>0?-r:Math.min(Math.max(-r,-l),r),p=-d*d+u*(u+2*l)+c):u<=m?(d=0,u=Math.min(Math.max(-r,-l),r),p=u*(u+2*l)+c):(d=Math.max(0,-(o*r+a)),u=d>0?r:Math.min(Math.max(-r,-l),r),p=-d*d+u*(u+2*l)+c);else u=o>0?-r:r,d=Math.max(0,-(o*u+a)),p=-d*d+u*(u+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,d),s&&s.copy(qd).addScaledVector(ac,u),p}intersectSphere(t,e){if(t.radius<0)return null;vs.subVectors(t.center,this.origin);let n=vs.dot(this.direction),s=vs.dot(vs)-n*n,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,e):this.at(a,e)}intersectsSphere(t){return t.radius<0?!1:this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(t.normal)+t.constant)/e;return n>=0?n:null}intersectPlane(t,e){let n=this.distanceToPlane(t);return n===null?null:this.at(n,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,d=1/this.direction.z,u=this.origin;return c>=0?(n=(t.min.x-u.x)*c,s=(t.max.x-u.x)*c):(n=(t.max.x-u.x)*c,s=(t.min.x-u.x)*c),h>=0?(r=(t.min.y-u.y)*h,o=(t.max.y-u.y)*h):(r=(t.max.y-u.y)*h,o=(t.min.y-u.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),d>=0?(a=(t.min.z-u.z)*d,l=(t.max.z-u.z)*d):(a=(t.max.z-u.z)*d,l=(t.min.z-u.z)*d),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,e)}intersectsBox(t){return this.intersectBox(t,vs)!==null}intersectTriangle(t,e,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,h=a.z,d=t.x-o.x,u=t.y-o.y,p=t.z-o.z,m=e.x-o.x,x=e.y-o.y,g=e.z-o.z,_=n.x-o.x,b=n.y-o.y,S=n.z-o.z,y=Math.abs(l),C=Math.abs(c),E=Math.abs(h),v,T,F,L,D,B,G,N,W,q,V,lt;if(y>=C&&y>=E?(F=l,B=d,W=m,lt=_,l>=0?(v=c,T=h,L=u,D=p,G=x,N=g,q=b,V=S):(v=h,T=c,L=p,D=u,G=g,N=x,q=S,V=b)):C>=E?(F=c,B=u,W=x,lt=b,c>=0?(v=h,T=l,L=p,D=d,G=g,N=m,q=S,V=_):(v=l,T=h,L=d,D=p,G=m,N=g,q=_,V=S)):(F=h,B=p,W=g,lt=S,h>=0?(v=l,T=c,L=d,D=u,G=m,N=x,q=_,V=b):(v=c,T=l,L=u,D=d,G=x,N=m,q=b,V=_)),F===0)return null;let Z=v/F,j=T/F,et=1/F,dt=L-Z*B,ut=D-j*B,tt=G-Z*W,gt=N-j*W,vt=q-Z*lt,Rt=V-j*lt,St=vt*gt-Rt*tt,$t=dt*Rt-ut*vt,re=tt*ut-gt*dt;if(s){if(St<0||$t<0||re<0)return null}else if((St<0||$t<0||re<0)&&(St>0||$t>0||re>0))return null;let Gt=St+$t+re;if(Gt===0)return null;let de=et*(St*B+$t*W+re*lt);return(Gt>0?de<0:de>0)?null:this.at(de/Gt,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},Wn=class extends zi{constructor(t){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Zt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ts,this.combine=oh,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}},C0=new Ve,Mr=new ws,cc=new Ys,P0=new H,hc=new H,uc=new H,dc=new H,Yd=new H,fc=new H,I0=new H,pc=new H,Ie=class extends Rn{constructor(t=new Fe,e=new Wn){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){fc.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],d=r[l];h!==0&&(Yd.fromBufferAttribute(d,t),o?fc.addScaledVector(Yd,h):fc.addScaledVector(Yd.sub(e),h))}e.add(fc)}return e}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),cc.copy(n.boundingSphere),cc.applyMatrix4(r),Mr.copy(t.ray).recast(t.near),!(cc.containsPoint(Mr.origin)===!1&&(Mr.intersectSphere(cc,P0)===null||Mr.origin.distanceToSquared(P0)>(t.far-t.near)**2))&&(C0.copy(r).invert(),Mr.copy(t.ray).applyMatrix4(C0),!(n.boundingBox!==null&&Mr.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(t,e,Mr)))}_computeIntersections(t,e,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,d=r.attributes.normal,u=r.groups,p=r.drawRange;if(a!==null)if(Array.isArray(o))for(let m=0,x=u.length;m<x;m++){let g=u[m],_=o[g.materialIndex],b=Math.max(g.start,p.start),S=Math.min(a.count,Math.min(g.start+g.count,p.start+p.count));for(let y=b,C=S;y<C;y+=3){let E=a.getX(y),v=a.getX(y+1),T=a.getX(y+2);s=mc(this,_,t,n,c,h,d,E,v,T),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=g.materialIndex,e.push(s))}}else{let m=Math.max(0,p.start),x=Math.min(a.count,p.start+p.count);for(let g=m,_=x;g<_;g+=3){let b=a.getX(g),S=a.getX(g+1),y=a.getX(g+2);s=mc(this,o,t,n,c,h,d,b,S,y),s&&(s.faceIndex=Math.floor(g/3),e.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let m=0,x=u.length;m<x;m++){let g=u[m],_=o[g.materialIndex],b=Math.max(g.start,p.start),S=Math.min(l.count,Math.min(g.start+g.count,p.start+p.count));for(let y=b,C=S;y<C;y+=3){let E=y,v=y+1,T=y+2;s=mc(this,_,t,n,c,h,d,E,v,T),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=g.materialIndex,e.push(s))}}else{let m=Math.max(0,p.start),x=Math.min(l.count,p.start+p.count);for(let g=m,_=x;g<_;g+=3){let b=g,S=g+1,y=g+2;s=mc(this,o,t,n,c,h,d,b,S,y),s&&(s.faceIndex=Math.floor(g/3),e.push(s))}}}};function eS(i,t,e,n,s,r,o,a){let l;if(t.side===li?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,t.side===ar,a),l===null)return null;pc.copy(a),pc.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(pc);return c<e.near||c>e.far?null:{distance:c,point:pc.clone(),object:i}}function mc(i,t,e,n,s,r,o,a,l,c){i.getVertexPosition(a,hc),i.getVertexPosition(l,uc),i.getVertexPosition(c,dc);let h=eS(i,t,e,n,hc,uc,dc,I0);if(h){let d=new H;Xs.getBarycoord(I0,hc,uc,dc,d),s&&(h.uv=Xs.getInterpolatedAttribute(s,a,l,c,d,new Vt)),r&&(h.uv1=Xs.getInterpolatedAttribute(r,a,l,c,d,new Vt)),o&&(h.normal=Xs.getInterpolatedAttribute(o,a,l,c,d,new H),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let u={a,b:l,c,normal:new H,materialIndex:0};Xs.getNormal(hc,uc,dc,u.normal),h.face=u,h.barycoord=d}return h}var Ri=class extends Zn{constructor(t=null,e=1,n=1,s,r,o,a,l,c=Bn,h=Bn,d,u){super(null,o,a,l,c,h,s,r,d,u),this.isDataTexture=!0,this.image={data:t,width:e,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var Ss=class extends Ue{constructor(t,e,n,s=1){super(t,e,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=s}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}toJSON(){let t=super.toJSON();return t.meshPerAttribute=this.meshPerAttribute,t.isInstancedBufferAttribute=!0,t}};var Er=new Ys,nS=new Vt(.5,.5),gc=new H,Zs=class{constructor(t=new Gn,e=new Gn,n=new Gn,s=new Gn,r=new Gn,o=new Gn){this.planes=[t,e,n,s,r,o]}set(t,e,n,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let n=0;n<6;n++)e[n].copy(t.planes[n]);return this}setFromProjectionMatrix(t,e=Ai,n=!1){let s=this.planes,r=t.elements,o=r[0],a=r[1],l=r[2],c=r[3],h=r[4],d=r[5],u=r[6],p=r[7],m=r[8],x=r[9],g=r[10],_=r[11],b=r[12],S=r[13],y=r[14],C=r[15];if(s[0].setComponents(c-o,p-h,_-m,C-b).normalize(),s[1].setComponents(c+o,p+h,_+m,C+b).normalize(),s[2].setComponents(c+a,p+d,_+x,C+S).normalize(),s[3].setComponents(c-a,p-d,_-x,C-S).normalize(),n)s[4].setComponents(l,u,g,y).normalize(),s[5].setComponents(c-l,p-u,_-g,C-y).normalize();else if(s[4].setComponents(c-l,p-u,_-g,C-y).normalize(),e===Ai)s[5].setComponents(c+l,p+u,_+g,C+y).normalize();else if(e===Ro)s[5].setComponents(l,u,g,y).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),Er.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),Er.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(Er)}intersectsSprite(t){Er.center.set(0,0,0);let e=nS.distanceTo(t.center);return Er.radius=.7071067811865476+e,Er.applyMatrix4(t.matrixWorld),this.intersectsSphere(Er)}intersectsSphere(t){let e=this.planes,n=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let n=0;n<6;n++){let s=e[n];if(gc.x=s.normal.x>0?t.max.x:t.min.x,gc.y=s.normal.y>0?t.max.y:t.min.y,gc.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(gc)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let n=0;n<6;n++)if(e[n].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},L0=new Ve,Hc=class i{constructor(){this.coordinateSystem=Ai,this._frustums=[],this._count=0}setFromArrayCamera(t){let e=t.cameras,n=this._frustums;for(let s=0;s<e.length;s++){let r=e[s];L0.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new Zs),n[s].setFromProjectionMatrix(L0,r.coordinateSystem,r.reversedDepth)}return this._count=e.length,this}getFrustum(t){return this._frustums[t]}intersectsObject(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsObject(t))return!0;return!1}intersectsSprite(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSprite(t))return!0;return!1}intersectsSphere(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSphere(t))return!0;return!1}intersectsBox(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsBox(t))return!0;return!1}containsPoint(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].containsPoint(t))return!0;return!1}copy(t){this.coordinateSystem=t.coordinateSystem;let e=this._frustums,n=t._frustums;for(let s=0;s<t._count;s++)e[s]===void 0&&(e[s]=new Zs),e[s].copy(n[s]);return this._count=t._count,this}clone(){return new i().copy(this)}};var Hi=class extends zi{constructor(t){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Zt(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},Gc=new H,Vc=new H,D0=new Ve,pa=new ws,_c=new Ys,Zd=new H,N0=new H,No=class extends Rn{constructor(t=new Fe,e=new Hi){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[0];for(let s=1,r=e.count;s<r;s++)Gc.fromBufferAttribute(e,s-1),Vc.fromBufferAttribute(e,s),n[s]=n[s-1],n[s]+=Gc.distanceTo(Vc);t.setAttribute("lineDistance",new Ee(n,1))}else Yt("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),_c.copy(n.boundingSphere),_c.applyMatrix4(s),_c.radius+=r,t.ray.intersectsSphere(_c)===!1)return;D0.copy(s).invert(),pa.copy(t.ray).applyMatrix4(D0);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,u=n.attributes.position;if(h!==null){let p=Math.max(0,o.start),m=Math.min(h.count,o.start+o.count);for(let x=p,g=m-1;x<g;x+=c){let _=h.getX(x),b=h.getX(x+1),S=yc(this,t,pa,l,_,b,x);S&&e.push(S)}if(this.isLineLoop){let x=h.getX(m-1),g=h.getX(p),_=yc(this,t,pa,l,x,g,m-1);_&&e.push(_)}}else{let p=Math.max(0,o.start),m=Math.min(u.count,o.start+o.count);for(let x=p,g=m-1;x<g;x+=c){let _=yc(this,t,pa,l,x,x+1,x);_&&e.push(_)}if(this.isLineLoop){let x=yc(this,t,pa,l,m-1,p,m-1);x&&e.push(x)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function yc(i,t,e,n,s,r,o){let a=i.geometry.attributes.position;if(Gc.fromBufferAttribute(a,s),Vc.fromBufferAttribute(a,r),e.distanceSqToSegment(Gc,Vc,Zd,N0)>n)return;Zd.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(Zd);if(!(c<t.near||c>t.far))return{distance:c,point:N0.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var U0=new H,F0=new H,Tr=class extends No{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[];for(let s=0,r=e.count;s<r;s+=2)U0.fromBufferAttribute(e,s),F0.fromBufferAttribute(e,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+U0.distanceTo(F0);t.setAttribute("lineDistance",new Ee(n,1))}else Yt("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}},Ra=class extends No{constructor(t,e){super(t,e),this.isLineLoop=!0,this.type="LineLoop"}},Uo=class extends zi{constructor(t){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new Zt(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.alphaMap=t.alphaMap,this.size=t.size,this.sizeAttenuation=t.sizeAttenuation,this.fog=t.fog,this}},O0=new Ve,nf=new ws,vc=new Ys,xc=new H,Ca=class extends Rn{constructor(t=new Fe,e=new Uo){super(),this.isPoints=!0,this.type="Points",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Points.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),vc.copy(n.boundingSphere),vc.applyMatrix4(s),vc.radius+=r,t.ray.intersectsSphere(vc)===!1)return;O0.copy(s).invert(),nf.copy(t.ray).applyMatrix4(O0);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=n.index,d=n.attributes.position;if(c!==null){let u=Math.max(0,o.start),p=Math.min(c.count,o.start+o.count);for(let m=u,x=p;m<x;m++){let g=c.getX(m);xc.fromBufferAttribute(d,g),k0(xc,g,l,s,t,e,this)}}else{let u=Math.max(0,o.start),p=Math.min(d.count,o.start+o.count);for(let m=u,x=p;m<x;m++)xc.fromBufferAttribute(d,m),k0(xc,m,l,s,t,e,this)}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function k0(i,t,e,n,s,r,o){let a=nf.distanceSqToPoint(i);if(a<e){let l=new H;nf.closestPointToPoint(i,l),l.applyMatrix4(n);let c=s.ray.origin.distanceTo(l);if(c<s.near||c>s.far)return;r.push({distance:c,distanceToRay:Math.sqrt(a),point:l,index:t,face:null,faceIndex:null,barycoord:null,object:o})}}var Pa=class extends Zn{constructor(t=[],e=Dr,n,s,r,o,a,l,c,h){super(t,e,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}};var Ms=class extends Zn{constructor(t,e,n=Gi,s,r,o,a=Bn,l=Bn,c,h=bs,d=1){if(h!==bs&&h!==As)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let u={width:t,height:e,depth:d};super(u,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.source=new Io(Object.assign({},t.image)),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return e.compareFunction=this.compareFunction,e}},Ia=class extends Ms{constructor(t,e=Gi,n=Dr,s,r,o=Bn,a=Bn,l,c=bs){let h={width:t,height:t,depth:1},d=[h,h,h,h,h,h];super(t,t,e,n,s,r,o,a,l,c),this.image=d,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(t){this.image=t}},La=class extends Zn{constructor(t=null){super(),this.sourceTexture=t,this.isExternalTexture=!0}copy(t){return super.copy(t),this.sourceTexture=t.sourceTexture,this}},Ks=class i extends Fe{constructor(t=1,e=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],d=[],u=0,p=0;m("z","y","x",-1,-1,n,e,t,o,r,0),m("z","y","x",1,-1,n,e,-t,o,r,1),m("x","z","y",1,1,t,n,e,s,o,2),m("x","z","y",1,-1,t,n,-e,s,o,3),m("x","y","z",1,-1,t,e,n,s,r,4),m("x","y","z",-1,-1,t,e,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Ee(c,3)),this.setAttribute("normal",new Ee(h,3)),this.setAttribute("uv",new Ee(d,2));function m(x,g,_,b,S,y,C,E,v,T,F){let L=y/v,D=C/T,B=y/2,G=C/2,N=E/2,W=v+1,q=T+1,V=0,lt=0,Z=new H;for(let j=0;j<q;j++){let et=j*D-G;for(let dt=0;dt<W;dt++){let ut=dt*L-B;Z[x]=ut*b,Z[g]=et*S,Z[_]=N,c.push(Z.x,Z.y,Z.z),Z[x]=0,Z[g]=0,Z[_]=E>0?1:-1,h.push(Z.x,Z.y,Z.z),d.push(dt/v),d.push(1-j/T),V+=1}}for(let j=0;j<T;j++)for(let et=0;et<v;et++){let dt=u+et+W*j,ut=u+et+W*(j+1),tt=u+(et+1)+W*(j+1),gt=u+(et+1)+W*j;l.push(dt,ut,gt),l.push(ut,tt,gt),lt+=6}a.addGroup(p,lt,F),p+=lt,u+=V}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};var Js=class i extends Fe{constructor(t=1,e=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:t,radiusBottom:e,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let h=[],d=[],u=[],p=[],m=0,x=[],g=n/2,_=0;b(),o===!1&&(t>0&&S(!0),e>0&&S(!1)),this.setIndex(h),this.setAttribute("position",new Ee(d,3)),this.setAttribute("normal",new Ee(u,3)),this.setAttribute("uv",new Ee(p,2));function b(){let y=new H,C=new H,E=0,v=(e-t)/n;for(let T=0;T<=r;T++){let F=[],L=T/r,D=L*(e-t)+t;for(let B=0;B<=s;B++){let G=B/s,N=G*l+a,W=Math.sin(N),q=Math.cos(N);C.x=D*W,C.y=-L*n+g,C.z=D*q,d.push(C.x,C.y,C.z),y.set(W,v,q).normalize(),u.push(y.x,y.y,y.z),p.push(G,1-L),F.push(m++)}x.push(F)}for(let T=0;T<s;T++)for(let F=0;F<r;F++){let L=x[F][T],D=x[F+1][T],B=x[F+1][T+1],G=x[F][T+1];(t>0||F!==0)&&(h.push(L,D,G),E+=3),(e>0||F!==r-1)&&(h.push(D,B,G),E+=3)}c.addGroup(_,E,0),_+=E}function S(y){let C=m,E=new Vt,v=new H,T=0,F=y===!0?t:e,L=y===!0?1:-1;for(let B=1;B<=s;B++)d.push(0,g*L,0),u.push(0,L,0),p.push(.5,.5),m++;let D=m;for(let B=0;B<=s;B++){let N=B/s*l+a,W=Math.cos(N),q=Math.sin(N);v.x=F*q,v.y=g*L,v.z=F*W,d.push(v.x,v.y,v.z),u.push(0,L,0),E.x=W*.5+.5,E.y=q*.5*L+.5,p.push(E.x,E.y),m++}for(let B=0;B<s;B++){let G=C+B,N=D+B;y===!0?h.push(N,N+1,G):h.push(N+1,N,G),T+=3}c.addGroup(_,T,y===!0?1:2),_+=T}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radiusTop,t.radiusBottom,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},Wc=class i extends Js{constructor(t=1,e=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,t,e,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:t,height:e,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(t){return new i(t.radius,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},$c=class i extends Fe{constructor(t=[],e=[],n=1,s=0){super(),this.type="PolyhedronGeometry",this.parameters={vertices:t,indices:e,radius:n,detail:s};let r=[],o=[];a(s),c(n),h(),this.setAttribute("position",new Ee(r,3)),this.setAttribute("normal",new Ee(r.slice(),3)),this.setAttribute("uv",new Ee(o,2)),s===0?this.computeVertexNormals():this.normalizeNormals();function a(b){let S=new H,y=new H,C=new H;for(let E=0;E<e.length;E+=3)p(e[E+0],S),p(e[E+1],y),p(e[E+2],C),l(S,y,C,b)}function l(b,S,y,C){let E=C+1,v=[];for(let T=0;T<=E;T++){v[T]=[];let F=b.clone().lerp(y,T/E),L=S.clone().lerp(y,T/E),D=E-T;for(let B=0;B<=D;B++)B===0&&T===E?v[T][B]=F:v[T][B]=F.clone().lerp(L,B/D)}for(let T=0;T<E;T++)for(let F=0;F<2*(E-T)-1;F++){let L=Math.floor(F/2);F%2===0?(u(v[T][L+1]),u(v[T+1][L]),u(v[T][L])):(u(v[T][L+1]),u(v[T+1][L+1]),u(v[T+1][L]))}}function c(b){let S=new H;for(let y=0;y<r.length;y+=3)S.x=r[y+0],S.y=r[y+1],S.z=r[y+2],S.normalize().multiplyScalar(b),r[y+0]=S.x,r[y+1]=S.y,r[y+2]=S.z}function h(){let b=new H;for(let S=0;S<r.length;S+=3){b.x=r[S+0],b.y=r[S+1],b.z=r[S+2];let y=g(b)/2/Math.PI+.5,C=_(b)/Math.PI+.5;o.push(y,1-C)}m(),d()}function d(){for(let b=0;b<o.length;b+=6){let S=o[b+0],y=o[b+2],C=o[b+4],E=Math.max(S,y,C),v=Math.min(S,y,C);E>.9&&v<.1&&(S<.2&&(o[b+0]+=1),y<.2&&(o[b+2]+=1),C<.2&&(o[b+4]+=1))}}function u(b){r.push(b.x,b.y,b.z)}function p(b,S){let y=b*3;S.x=t[y+0],S.y=t[y+1],S.z=t[y+2]}function m(){let b=new H,S=new H,y=new H,C=new H,E=new Vt,v=new Vt,T=new Vt;for(let F=0,L=0;F<r.length;F+=9,L+=6){b.set(r[F+0],r[F+1],r[F+2]),S.set(r[F+3],r[F+4],r[F+5]),y.set(r[F+6],r[F+7],r[F+8]),E.set(o[L+0],o[L+1]),v.set(o[L+2],o[L+3]),T.set(o[L+4],o[L+5]),C.copy(b).add(S).add(y).divideScalar(3);let D=g(C);x(E,L+0,b,D),x(v,L+2,S,D),x(T,L+4,y,D)}}function x(b,S,y,C){C<0&&b.x===1&&(o[S]=b.x-1),y.x===0&&y.z===0&&(o[S]=C/2/Math.PI+.5)}function g(b){return Math.atan2(b.z,-b.x)}function _(b){return Math.atan2(-b.y,Math.sqrt(b.x*b.x+b.z*b.z))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.vertices,t.indices,t.radius,t.detail)}};function iS(i,t,e=2){let n=t&&t.length,s=n?t[0]*e:i.length,r=k_(i,0,s,e,!0),o=[];if(!r||r.next===r.prev)return o;let a,l,c;if(n&&(r=lS(i,t,r,e)),i.length>80*e){a=i[0],l=i[1];let h=a,d=l;for(let u=e;u<s;u+=e){let p=i[u],m=i[u+1];p<a&&(a=p),m<l&&(l=m),p>h&&(h=p),m>d&&(d=m)}c=Math.max(h-a,d-l),c=c!==0?32767/c:0}return Da(r,o,e,a,l,c,0),o}function k_(i,t,e,n,s){let r;if(s===vS(i,t,e,n)>0)for(let o=t;o<e;o+=n)r=B0(o/n|0,i[o],i[o+1],r);else for(let o=e-n;o>=t;o-=n)r=B0(o/n|0,i[o],i[o+1],r);return r&&Fo(r,r.next)&&(Ua(r),r=r.next),r}function Ar(i,t){if(!i)return i;t||(t=i);let e=i,n;do if(n=!1,!e.steiner&&(Fo(e,e.next)||rn(e.prev,e,e.next)===0)){if(Ua(e),e=t=e.prev,e===e.next)break;n=!0}else e=e.next;while(n||e!==t);return t}function Da(i,t,e,n,s,r,o){if(!i)return;!o&&r&&fS(i,n,s,r);let a=i;for(;i.prev!==i.next;){let l=i.prev,c=i.next;if(r?rS(i,n,s,r):sS(i)){t.push(l.i,i.i,c.i),Ua(i),i=c.next,a=c.next;continue}if(i=c,i===a){o?o===1?(i=oS(Ar(i),t),Da(i,t,e,n,s,r,2)):o===2&&aS(i,t,e,n,s,r):Da(Ar(i),t,e,n,s,r,1);break}}}function sS(i){let t=i.prev,e=i,n=i.next;if(rn(t,e,n)>=0)return!1;let s=t.x,r=e.x,o=n.x,a=t.y,l=e.y,c=n.y,h=Math.min(s,r,o),d=Math.min(a,l,c),u=Math.max(s,r,o),p=Math.max(a,l,c),m=n.next;for(;m!==t;){if(m.x>=h&&m.x<=u&&m.y>=d&&m.y<=p&&ma(s,a,r,l,o,c,m.x,m.y)&&rn(m.prev,m,m.next)>=0)return!1;m=m.next}return!0}function rS(i,t,e,n){let s=i.prev,r=i,o=i.next;if(rn(s,r,o)>=0)return!1;let a=s.x,l=r.x,c=o.x,h=s.y,d=r.y,u=o.y,p=Math.min(a,l,c),m=Math.min(h,d,u),x=Math.max(a,l,c),g=Math.max(h,d,u),_=sf(p,m,t,e,n),b=sf(x,g,t,e,n),S=i.prevZ,y=i.nextZ;for(;S&&S.z>=_&&y&&y.z<=b;){if(S.x>=p&&S.x<=x&&S.y>=m&&S.y<=g&&S!==s&&S!==o&&ma(a,h,l,d,c,u,S.x,S.y)&&rn(S.prev,S,S.next)>=0||(S=S.prevZ,y.x>=p&&y.x<=x&&y.y>=m&&y.y<=g&&y!==s&&y!==o&&ma(a,h,l,d,c,u,y.x,y.y)&&rn(y.prev,y,y.next)>=0))return!1;y=y.nextZ}for(;S&&S.z>=_;){if(S.x>=p&&S.x<=x&&S.y>=m&&S.y<=g&&S!==s&&S!==o&&ma(a,h,l,d,c,u,S.x,S.y)&&rn(S.prev,S,S.next)>=0)return!1;S=S.prevZ}for(;y&&y.z<=b;){if(y.x>=p&&y.x<=x&&y.y>=m&&y.y<=g&&y!==s&&y!==o&&ma(a,h,l,d,c,u,y.x,y.y)&&rn(y.prev,y,y.next)>=0)return!1;y=y.nextZ}return!0}function oS(i,t){let e=i;do{let n=e.prev,s=e.next.next;!Fo(n,s)&&z_(n,e,e.next,s)&&Na(n,s)&&Na(s,n)&&(t.push(n.i,e.i,s.i),Ua(e),Ua(e.next),e=i=s),e=e.next}while(e!==i);return Ar(e)}function aS(i,t,e,n,s,r){let o=i;do{let a=o.next.next;for(;a!==o.prev;){if(o.i!==a.i&&gS(o,a)){let l=H_(o,a);o=Ar(o,o.next),l=Ar(l,l.next),Da(o,t,e,n,s,r,0),Da(l,t,e,n,s,r,0);return}a=a.next}o=o.next}while(o!==i)}function lS(i,t,e,n){let s=[];for(let r=0,o=t.length;r<o;r++){let a=t[r]*n,l=r<o-1?t[r+1]*n:i.length,c=k_(i,a,l,n,!1);c===c.next&&(c.steiner=!0),s.push(mS(c))}s.sort(cS);for(let r=0;r<s.length;r++)e=hS(s[r],e);return e}function cS(i,t){let e=i.x-t.x;if(e===0&&(e=i.y-t.y,e===0)){let n=(i.next.y-i.y)/(i.next.x-i.x),s=(t.next.y-t.y)/(t.next.x-t.x);e=n-s}return e}function hS(i,t){let e=uS(i,t);if(!e)return t;let n=H_(e,i);return Ar(n,n.next),Ar(e,e.next)}function uS(i,t){let e=t,n=i.x,s=i.y,r=-1/0,o;if(Fo(i,e))return e;do{if(Fo(i,e.next))return e.next;if(s<=e.y&&s>=e.next.y&&e.next.y!==e.y){let d=e.x+(s-e.y)*(e.next.x-e.x)/(e.next.y-e.y);if(d<=n&&d>r&&(r=d,o=e.x<e.next.x?e:e.next,d===n))return o}e=e.next}while(e!==t);if(!o)return null;let a=o,l=o.x,c=o.y,h=1/0;e=o;do{if(n>=e.x&&e.x>=l&&n!==e.x&&B_(s<c?n:r,s,l,c,s<c?r:n,s,e.x,e.y)){let d=Math.abs(s-e.y)/(n-e.x);Na(e,i)&&(d<h||d===h&&(e.x>o.x||e.x===o.x&&dS(o,e)))&&(o=e,h=d)}e=e.next}while(e!==a);return o}function dS(i,t){return rn(i.prev,i,t.prev)<0&&rn(t.next,i,i.next)<0}function fS(i,t,e,n){let s=i;do s.z===0&&(s.z=sf(s.x,s.y,t,e,n)),s.prevZ=s.prev,s.nextZ=s.next,s=s.next;while(s!==i);s.prevZ.nextZ=null,s.prevZ=null,pS(s)}function pS(i){let t,e=1;do{let n=i,s;i=null;let r=null;for(t=0;n;){t++;let o=n,a=0;for(let c=0;c<e&&(a++,o=o.nextZ,!!o);c++);let l=e;for(;a>0||l>0&&o;)a!==0&&(l===0||!o||n.z<=o.z)?(s=n,n=n.nextZ,a--):(s=o,o=o.nextZ,l--),r?r.nextZ=s:i=s,s.prevZ=r,r=s;n=o}r.nextZ=null,e*=2}while(t>1);return i}function sf(i,t,e,n,s){return i=(i-e)*s|0,t=(t-n)*s|0,i=(i|i<<8)&16711935,i=(i|i<<4)&252645135,i=(i|i<<2)&858993459,i=(i|i<<1)&1431655765,t=(t|t<<8)&16711935,t=(t|t<<4)&252645135,t=(t|t<<2)&858993459,t=(t|t<<1)&1431655765,i|t<<1}function mS(i){let t=i,e=i;do(t.x<e.x||t.x===e.x&&t.y<e.y)&&(e=t),t=t.next;while(t!==i);return e}function B_(i,t,e,n,s,r,o,a){return(s-o)*(t-a)>=(i-o)*(r-a)&&(i-o)*(n-a)>=(e-o)*(t-a)&&(e-o)*(r-a)>=(s-o)*(n-a)}function ma(i,t,e,n,s,r,o,a){return!(i===o&&t===a)&&B_(i,t,e,n,s,r,o,a)}function gS(i,t){return i.next.i!==t.i&&i.prev.i!==t.i&&!_S(i,t)&&(Na(i,t)&&Na(t,i)&&yS(i,t)&&(rn(i.prev,i,t.prev)||rn(i,t.prev,t))||Fo(i,t)&&rn(i.prev,i,i.next)>0&&rn(t.prev,t,t.next)>0)}function rn(i,t,e){return(t.y-i.y)*(e.x-t.x)-(t.x-i.x)*(e.y-t.y)}function Fo(i,t){return i.x===t.x&&i.y===t.y}function z_(i,t,e,n){let s=wc(rn(i,t,e)),r=wc(rn(i,t,n)),o=wc(rn(e,n,i)),a=wc(rn(e,n,t));return!!(s!==r&&o!==a||s===0&&bc(i,e,t)||r===0&&bc(i,n,t)||o===0&&bc(e,i,n)||a===0&&bc(e,t,n))}function bc(i,t,e){return t.x<=Math.max(i.x,e.x)&&t.x>=Math.min(i.x,e.x)&&t.y<=Math.max(i.y,e.y)&&t.y>=Math.min(i.y,e.y)}function wc(i){return i>0?1:i<0?-1:0}function _S(i,t){let e=i;do{if(e.i!==i.i&&e.next.i!==i.i&&e.i!==t.i&&e.next.i!==t.i&&z_(e,e.next,i,t))return!0;e=e.next}while(e!==i);return!1}function Na(i,t){return rn(i.prev,i,i.next)<0?rn(i,t,i.next)>=0&&rn(i,i.prev,t)>=0:rn(i,t,i.prev)<0||rn(i,i.next,t)<0}function yS(i,t){let e=i,n=!1,s=(i.x+t.x)/2,r=(i.y+t.y)/2;do e.y>r!=e.next.y>r&&e.next.y!==e.y&&s<(e.next.x-e.x)*(r-e.y)/(e.next.y-e.y)+e.x&&(n=!n),e=e.next;while(e!==i);return n}function H_(i,t){let e=rf(i.i,i.x,i.y),n=rf(t.i,t.x,t.y),s=i.next,r=t.prev;return i.next=t,t.prev=i,e.next=s,s.prev=e,n.next=e,e.prev=n,r.next=n,n.prev=r,n}function B0(i,t,e,n){let s=rf(i,t,e);return n?(s.next=n.next,s.prev=n,n.next.prev=s,n.next=s):(s.prev=s,s.next=s),s}function Ua(i){i.next.prev=i.prev,i.prev.next=i.next,i.prevZ&&(i.prevZ.nextZ=i.nextZ),i.nextZ&&(i.nextZ.prevZ=i.prevZ)}function rf(i,t,e){return{i,x:t,y:e,prev:null,next:null,z:0,prevZ:null,nextZ:null,steiner:!1}}function vS(i,t,e,n){let s=0;for(let r=t,o=e-n;r<e;r+=n)s+=(i[o]-i[r])*(i[r+1]+i[o+1]),o=r;return s}var of=class{static triangulate(t,e,n=2){return iS(t,e,n)}},Oo=class i{static area(t){let e=t.length,n=0;for(let s=e-1,r=0;r<e;s=r++)n+=t[s].x*t[r].y-t[r].x*t[s].y;return n*.5}static isClockWise(t){return i.area(t)<0}static triangulateShape(t,e){let n=[],s=[],r=[];z0(t),H0(n,t);let o=t.length;e.forEach(z0);for(let l=0;l<e.length;l++)s.push(o),o+=e[l].length,H0(n,e[l]);let a=of.triangulate(n,s);for(let l=0;l<a.length;l+=3)r.push(a.slice(l,l+3));return r}};function z0(i){let t=i.length;t>2&&i[t-1].equals(i[0])&&i.pop()}function H0(i,t){for(let e=0;e<t.length;e++)i.push(t[e].x),i.push(t[e].y)}var Fa=class i extends $c{constructor(t=1,e=0){let n=(1+Math.sqrt(5))/2,s=[-1,n,0,1,n,0,-1,-n,0,1,-n,0,0,-1,n,0,1,n,0,-1,-n,0,1,-n,n,0,-1,n,0,1,-n,0,-1,-n,0,1],r=[0,11,5,0,5,1,0,1,7,0,7,10,0,10,11,1,5,9,5,11,4,11,10,2,10,7,6,7,1,8,3,9,4,3,4,2,3,2,6,3,6,8,3,8,9,4,9,5,2,4,11,6,2,10,8,6,7,9,8,1];super(s,r,t,e),this.type="IcosahedronGeometry",this.parameters={radius:t,detail:e}}static fromJSON(t){return new i(t.radius,t.detail)}};var Es=class i extends Fe{constructor(t=1,e=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:n,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,d=t/a,u=e/l,p=[],m=[],x=[],g=[];for(let _=0;_<h;_++){let b=_*u-o;for(let S=0;S<c;S++){let y=S*d-r;m.push(y,-b,0),x.push(0,0,1),g.push(S/a),g.push(1-_/l)}}for(let _=0;_<l;_++)for(let b=0;b<a;b++){let S=b+c*_,y=b+c*(_+1),C=b+1+c*(_+1),E=b+1+c*_;p.push(S,y,E),p.push(y,C,E)}this.setIndex(p),this.setAttribute("position",new Ee(m,3)),this.setAttribute("normal",new Ee(x,3)),this.setAttribute("uv",new Ee(g,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.widthSegments,t.heightSegments)}},Rr=class i extends Fe{constructor(t=.5,e=1,n=32,s=1,r=0,o=Math.PI*2){super(),this.type="RingGeometry",this.parameters={innerRadius:t,outerRadius:e,thetaSegments:n,phiSegments:s,thetaStart:r,thetaLength:o},n=Math.max(3,n),s=Math.max(1,s);let a=[],l=[],c=[],h=[],d=t,u=(e-t)/s,p=new H,m=new Vt;for(let x=0;x<=s;x++){for(let g=0;g<=n;g++){let _=r+g/n*o;p.x=d*Math.cos(_),p.y=d*Math.sin(_),l.push(p.x,p.y,p.z),c.push(0,0,1),m.x=(p.x/e+1)/2,m.y=(p.y/e+1)/2,h.push(m.x,m.y)}d+=u}for(let x=0;x<s;x++){let g=x*(n+1);for(let _=0;_<n;_++){let b=_+g,S=b,y=b+n+1,C=b+n+2,E=b+1;a.push(S,y,E),a.push(y,C,E)}}this.setIndex(a),this.setAttribute("position",new Ee(l,3)),this.setAttribute("normal",new Ee(c,3)),this.setAttribute("uv",new Ee(h,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.innerRadius,t.outerRadius,t.thetaSegments,t.phiSegments,t.thetaStart,t.thetaLength)}};function Fr(i){let t={};for(let e in i){t[e]={};for(let n in i[e]){let s=i[e][n];if(G0(s))s.isRenderTargetTexture?(Yt("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][n]=null):t[e][n]=s.clone();else if(Array.isArray(s))if(G0(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();t[e][n]=r}else t[e][n]=s.slice();else t[e][n]=s}}return t}function jn(i){let t={};for(let e=0;e<i.length;e++){let n=Fr(i[e]);for(let s in n)t[s]=n[s]}return t}function G0(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function xS(i){let t=[];for(let e=0;e<i.length;e++)t.push(i[e].clone());return t}function zf(i){let t=i.getRenderTarget();return t===null?i.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:xe.workingColorSpace}var G_={clone:Fr,merge:jn},bS=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,wS=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Ci=class extends zi{constructor(t){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=bS,this.fragmentShader=wS,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=Fr(t.uniforms),this.uniformsGroups=xS(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this.defaultAttributeValues=Object.assign({},t.defaultAttributeValues),this.index0AttributeName=t.index0AttributeName,this.uniformsNeedUpdate=t.uniformsNeedUpdate,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(e.extensions=n),e}fromJSON(t,e){if(super.fromJSON(t,e),t.uniforms!==void 0)for(let n in t.uniforms){let s=t.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=e[s.value]||null;break;case"c":this.uniforms[n].value=new Zt().setHex(s.value);break;case"v2":this.uniforms[n].value=new Vt().fromArray(s.value);break;case"v3":this.uniforms[n].value=new H().fromArray(s.value);break;case"v4":this.uniforms[n].value=new Qe().fromArray(s.value);break;case"m3":this.uniforms[n].value=new ne().fromArray(s.value);break;case"m4":this.uniforms[n].value=new Ve().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(t.defines!==void 0&&(this.defines=t.defines),t.vertexShader!==void 0&&(this.vertexShader=t.vertexShader),t.fragmentShader!==void 0&&(this.fragmentShader=t.fragmentShader),t.glslVersion!==void 0&&(this.glslVersion=t.glslVersion),t.extensions!==void 0)for(let n in t.extensions)this.extensions[n]=t.extensions[n];return t.lights!==void 0&&(this.lights=t.lights),t.clipping!==void 0&&(this.clipping=t.clipping),this}},Xc=class extends Ci{constructor(t){super(t),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}},Cr=class extends zi{constructor(t){super(),this.isMeshStandardMaterial=!0,this.type="MeshStandardMaterial",this.defines={STANDARD:""},this.color=new Zt(16777215),this.roughness=1,this.metalness=0,this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new Zt(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Qa,this.normalScale=new Vt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.roughnessMap=null,this.metalnessMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ts,this.envMapIntensity=1,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.defines={STANDARD:""},this.color.copy(t.color),this.roughness=t.roughness,this.metalness=t.metalness,this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.roughnessMap=t.roughnessMap,this.metalnessMap=t.metalnessMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.envMapIntensity=t.envMapIntensity,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}};var Kn=class extends zi{constructor(t){super(),this.isMeshLambertMaterial=!0,this.type="MeshLambertMaterial",this.color=new Zt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new Zt(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Qa,this.normalScale=new Vt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ts,this.combine=oh,this.reflectivity=1,this.envMapIntensity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.envMapIntensity=t.envMapIntensity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}},js=class extends zi{constructor(t){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=w_,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},qc=class extends zi{constructor(t){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}};var Oa=class extends Hi{constructor(t){super(),this.isLineDashedMaterial=!0,this.type="LineDashedMaterial",this.scale=1,this.dashSize=3,this.gapSize=1,this.setValues(t)}copy(t){return super.copy(t),this.scale=t.scale,this.dashSize=t.dashSize,this.gapSize=t.gapSize,this}};function wo(i,t){return!i||i.constructor===t?i:typeof t.BYTES_PER_ELEMENT=="number"?new t(i):Array.prototype.slice.call(i)}function Sc(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var Qs=class{constructor(t,e,n,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(n),this.sampleValues=e,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,n=this._cachedIndex,s=e[n],r=e[n-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=n+2;;){if(s===void 0){if(t<r)break i;return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=e[++n],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=e[--n-1],t>=r)break t}o=n,n=0;break e}break n}for(;n<o;){let a=n+o>>>1;t<e[a]?o=a:n=a+1}if(s=e[n],r=e[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=n[r+o];return e}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Yc=class extends Qs{constructor(t,e,n,s){super(t,e,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Qd,endingEnd:Qd}}intervalChanged_(t,e,n){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case tf:r=t,a=2*e-n;break;case ef:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case tf:o=t,l=2*n-e;break;case ef:o=1,l=n+s[1]-s[0];break;default:o=t-1,l=e}let c=(n-e)*.5,h=this.valueSize;this._weightPrev=c/(e-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this._offsetPrev,d=this._offsetNext,u=this._weightPrev,p=this._weightNext,m=(n-e)/(s-e),x=m*m,g=x*m,_=-u*g+2*u*x-u*m,b=(1+u)*g+(-1.5-2*u)*x+(-.5+u)*m+1,S=(-1-p)*g+(1.5+p)*x+.5*m,y=p*g-p*x;for(let C=0;C!==a;++C)r[C]=_*o[h+C]+b*o[c+C]+S*o[l+C]+y*o[d+C];return r}},Zc=class extends Qs{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=(n-e)/(s-e),d=1-h;for(let u=0;u!==a;++u)r[u]=o[c+u]*d+o[l+u]*h;return r}},Kc=class extends Qs{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t){return this.copySampleValue_(t-1)}},Jc=class extends Qs{interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this.inTangents,d=this.outTangents;if(!h||!d){let m=(n-e)/(s-e),x=1-m;for(let g=0;g!==a;++g)r[g]=o[c+g]*x+o[l+g]*m;return r}let u=a*2,p=t-1;for(let m=0;m!==a;++m){let x=o[c+m],g=o[l+m],_=p*u+m*2,b=d[_],S=d[_+1],y=t*u+m*2,C=h[y],E=h[y+1],v=MS(n,e,b,C,s);r[m]=V_(v,x,S,E,g)}return r}};function V_(i,t,e,n,s){let r=1-i;return r*r*r*t+3*r*r*i*e+3*r*i*i*n+i*i*i*s}function SS(i,t,e,n,s){let r=1-i;return 3*r*r*(e-t)+6*r*i*(n-e)+3*i*i*(s-n)}function MS(i,t,e,n,s){let r=(i-t)/(s-t);for(let o=0;o<8;o++){let a=V_(r,t,e,n,s)-i;if(Math.abs(a)<1e-10)break;let l=SS(r,t,e,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var bi=class{constructor(t,e,n,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=wo(e,this.TimeBufferType),this.values=wo(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,n;if(e.toJSON!==this.toJSON)n=e.toJSON(t);else{n={name:t.name,times:wo(t.times,Array),values:wo(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(n.interpolation=s),Sc(t.settings)&&(n.settings={inTangents:wo(t.settings.inTangents,Array),outTangents:wo(t.settings.outTangents,Array)})}return n.type=t.ValueTypeName,n}InterpolantFactoryMethodDiscrete(t){return new Kc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new Zc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new Yc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodBezier(t){let e=new Jc(this.times,this.values,this.getValueSize(),t);return this.settings&&(e.inTangents=this.settings.inTangents,e.outTangents=this.settings.outTangents),e}setInterpolation(t){let e;switch(t){case va:e=this.InterpolantFactoryMethodDiscrete;break;case Oc:e=this.InterpolantFactoryMethodLinear;break;case Ac:e=this.InterpolantFactoryMethodSmooth;break;case jd:e=this.InterpolantFactoryMethodBezier;break}if(e===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return Yt("KeyframeTrack:",n),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return va;case this.InterpolantFactoryMethodLinear:return Oc;case this.InterpolantFactoryMethodSmooth:return Ac;case this.InterpolantFactoryMethodBezier:return jd}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]+=t;Sc(this.settings)&&(V0(this.settings.inTangents,t),V0(this.settings.outTangents,t))}return this}scale(t){if(t!==1){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]*=t;Sc(this.settings)&&(W0(this.settings.inTangents,t),W0(this.settings.outTangents,t))}return this}trim(t,e){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<t;)++r;for(;o!==-1&&n[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(te("KeyframeTrack: Invalid value size in track.",this),t=!1);let n=this.times,s=this.values,r=n.length;r===0&&(te("KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){te("KeyframeTrack: Time is not a valid number.",this,a,l),t=!1;break}if(o!==null&&o>l){te("KeyframeTrack: Out of order keys.",this,a,l,o),t=!1;break}o=l}if(s!==void 0&&Sw(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){te("KeyframeTrack: Value is not a valid number.",this,a,c),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===Ac,r=t.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=t[a],h=t[a+1];if(c!==h&&(a!==1||c!==t[0]))if(s)l=!0;else{let d=a*n,u=d-n,p=d+n;for(let m=0;m!==n;++m){let x=e[d+m];if(x!==e[u+m]||x!==e[p+m]){l=!0;break}}}if(l){if(a!==o){t[o]=t[a];let d=a*n,u=o*n;for(let p=0;p!==n;++p)e[u+p]=e[d+p]}++o}}if(r>0){t[o]=t[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)e[l+c]=e[a+c];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*n)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),n=this.constructor,s=new n(this.name,t,e);return s.createInterpolant=this.createInterpolant,Sc(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function V0(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]+=t}function W0(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]*=t}bi.prototype.ValueTypeName="";bi.prototype.TimeBufferType=Float32Array;bi.prototype.ValueBufferType=Float32Array;bi.prototype.DefaultInterpolation=Oc;var tr=class extends bi{constructor(t,e,n){super(t,e,n)}};tr.prototype.ValueTypeName="bool";tr.prototype.ValueBufferType=Array;tr.prototype.DefaultInterpolation=va;tr.prototype.InterpolantFactoryMethodLinear=void 0;tr.prototype.InterpolantFactoryMethodSmooth=void 0;var jc=class extends bi{constructor(t,e,n,s){super(t,e,n,s)}};jc.prototype.ValueTypeName="color";var Qc=class extends bi{constructor(t,e,n,s){super(t,e,n,s)}};Qc.prototype.ValueTypeName="number";var th=class extends Qs{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-e)/(s-e),c=t*a;for(let h=c+a;c!==h;c+=4)ai.slerpFlat(r,0,o,c-a,o,c,l);return r}},ka=class extends bi{constructor(t,e,n,s){super(t,e,n,s)}InterpolantFactoryMethodLinear(t){return new th(this.times,this.values,this.getValueSize(),t)}};ka.prototype.ValueTypeName="quaternion";ka.prototype.InterpolantFactoryMethodSmooth=void 0;var er=class extends bi{constructor(t,e,n){super(t,e,n)}};er.prototype.ValueTypeName="string";er.prototype.ValueBufferType=Array;er.prototype.DefaultInterpolation=va;er.prototype.InterpolantFactoryMethodLinear=void 0;er.prototype.InterpolantFactoryMethodSmooth=void 0;var eh=class extends bi{constructor(t,e,n,s){super(t,e,n,s)}};eh.prototype.ValueTypeName="vector";var nh=class{constructor(t,e,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=n,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,d){return c.push(h,d),this},this.removeHandler=function(h){let d=c.indexOf(h);return d!==-1&&c.splice(d,2),this},this.getHandler=function(h){for(let d=0,u=c.length;d<u;d+=2){let p=c[d],m=c[d+1];if(p.global&&(p.lastIndex=0),p.test(h))return m}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},W_=new nh,ih=class{constructor(t){this.manager=t!==void 0?t:W_,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(t,e){let n=this;return new Promise(function(s,r){n.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}setPriority(t){return this.priority=t,this}setCache(t){return this.cache=t,this}abort(){return this}};ih.DEFAULT_MATERIAL_NAME="__DEFAULT";var Ba=class extends Rn{static registerNode(t){this.prototype._lightNode=t}constructor(t,e=1){super(),this.isLight=!0,this.type="Light",this.color=new Zt(t),this.intensity=e}copy(t,e){return super.copy(t,e),this.color.copy(t.color),this.intensity=t.intensity,this}toJSON(t){let e=super.toJSON(t);return e.object.color=this.color.getHex(),e.object.intensity=this.intensity,e}},za=class extends Ba{constructor(t,e,n){super(t,n),this.isHemisphereLight=!0,this.type="HemisphereLight",this.position.copy(Rn.DEFAULT_UP),this.updateMatrix(),this.groundColor=new Zt(e)}copy(t,e){return super.copy(t,e),this.groundColor.copy(t.groundColor),this}toJSON(t){let e=super.toJSON(t);return e.object.groundColor=this.groundColor.getHex(),e}},Kd=new Ve,$0=new H,X0=new H,sh=class{constructor(t){this.camera=t,this.intensity=1,this.bias=0,this.biasNode=null,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new Vt(512,512),this.mapType=ci,this.map=null,this.mapPass=null,this.matrix=new Ve,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new Zs,this._frameExtents=new Vt(1,1),this._viewportCount=1,this._viewports=[new Qe(0,0,1,1)]}getViewportCount(){return this._viewportCount}getCamera(){return this.camera}getFrustum(){return this._frustum}updateMatrices(t){let e=this.camera;$0.setFromMatrixPosition(t.matrixWorld),e.position.copy($0),X0.setFromMatrixPosition(t.target.matrixWorld),e.lookAt(X0),e.updateMatrixWorld(),this._updateMatrix(e,this.matrix,this._frustum)}_updateMatrix(t,e,n,s){Kd.multiplyMatrices(t.projectionMatrix,t.matrixWorldInverse),n.setFromProjectionMatrix(Kd,t.coordinateSystem,t.reversedDepth);let r=this._frameExtents,o=s?s.z/r.x:1,a=s?s.w/r.y:1,l=s?s.x/r.x:0,c=s?s.y/r.y:0;t.coordinateSystem===Ro||t.reversedDepth?e.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,1,0,0,0,0,1):e.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,.5,.5,0,0,0,1),e.multiply(Kd)}getViewport(t){return this._viewports[t]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(t){return this.camera=t.camera.clone(),this.intensity=t.intensity,this.bias=t.bias,this.radius=t.radius,this.autoUpdate=t.autoUpdate,this.needsUpdate=t.needsUpdate,this.normalBias=t.normalBias,this.blurSamples=t.blurSamples,this.mapSize.copy(t.mapSize),this.mapType=t.mapType,this.biasNode=t.biasNode,this}clone(){return new this.constructor().copy(this)}toJSON(){let t={};return t.intensity=this.intensity,t.bias=this.bias,t.normalBias=this.normalBias,t.radius=this.radius,t.blurSamples=this.blurSamples,t.mapSize=this.mapSize.toArray(),t.mapType=this.mapType,t.camera=this.camera.toJSON(!1).object,delete t.camera.matrix,t}},Mc=new H,Ec=new ai,ji=new H,Ha=class extends Rn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Ve,this.projectionMatrix=new Ve,this.projectionMatrixInverse=new Ve,this.coordinateSystem=Ai,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorld.decompose(Mc,Ec,ji),ji.x===1&&ji.y===1&&ji.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(Mc,Ec,ji.set(1,1,1)).invert()}updateWorldMatrix(t,e,n=!1){super.updateWorldMatrix(t,e,n),this.matrixWorld.decompose(Mc,Ec,ji),ji.x===1&&ji.y===1&&ji.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(Mc,Ec,ji.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},$s=new H,q0=new Vt,Y0=new Vt,oi=class extends Ha{constructor(t=50,e=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=Po*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(_a*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return Po*2*Math.atan(Math.tan(_a*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,n){$s.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set($s.x,$s.y).multiplyScalar(-t/$s.z),$s.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set($s.x,$s.y).multiplyScalar(-t/$s.z)}getViewSize(t,e){return this.getViewBounds(t,q0,Y0),e.subVectors(Y0,q0)}setViewOffset(t,e,n,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(_a*.5*this.fov)/this.zoom,n=2*e,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,e-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-n,t,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}};var Ga=class extends Ha{constructor(t=-1,e=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-t,o=n+t,a=s+e,l=s-e;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}},af=class extends sh{constructor(){super(new Ga(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},Va=class extends Ba{constructor(t,e){super(t,e),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(Rn.DEFAULT_UP),this.updateMatrix(),this.target=new Rn,this.shadow=new af}dispose(){super.dispose(),this.shadow.dispose()}copy(t){return super.copy(t),this.target=t.target.clone(),this.shadow=t.shadow.clone(),this}toJSON(t){let e=super.toJSON(t);return e.object.shadow=this.shadow.toJSON(),e.object.target=this.target.uuid,e}};var nr=class extends Fe{constructor(){super(),this.isInstancedBufferGeometry=!0,this.type="InstancedBufferGeometry",this.instanceCount=1/0}copy(t){return super.copy(t),this.instanceCount=t.instanceCount,this}toJSON(){let t=super.toJSON();return t.instanceCount=this.instanceCount,t.isInstancedBufferGeometry=!0,t}};var So=-90,Mo=1,ko=class extends Rn{constructor(t,e,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new oi(So,Mo,t,e);s.layers=this.layers,this.add(s);let r=new oi(So,Mo,t,e);r.layers=this.layers,this.add(r);let o=new oi(So,Mo,t,e);o.layers=this.layers,this.add(o);let a=new oi(So,Mo,t,e);a.layers=this.layers,this.add(a);let l=new oi(So,Mo,t,e);l.layers=this.layers,this.add(l);let c=new oi(So,Mo,t,e);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[n,s,r,o,a,l]=e;for(let c of e)this.remove(c);if(t===Ai)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(t===Ro)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let c of e)this.add(c),c.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,d=t.getRenderTarget(),u=t.getActiveCubeFace(),p=t.getActiveMipmapLevel(),m=t.xr.enabled;t.xr.enabled=!1;let x=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let g=!1;t.isWebGLRenderer===!0?g=t.state.buffers.depth.getReversed():g=t.reversedDepthBuffer,t.setRenderTarget(n,0,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,r),t.setRenderTarget(n,1,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,o),t.setRenderTarget(n,2,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,a),t.setRenderTarget(n,3,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,l),t.setRenderTarget(n,4,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,c),n.texture.mipmapsAutoUpdate=x,t.setRenderTarget(n,5,s),g&&t.autoClear===!1&&t.clearDepth(),t.render(e,h),t.setRenderTarget(d,u,p),t.xr.enabled=m,n.texture.needsPMREMUpdate=!0}},rh=class extends oi{constructor(t=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=t,this.perCameraFrustumCulled=!1}};var Hf="\\[\\]\\.:\\/",ES=new RegExp("["+Hf+"]","g"),Gf="[^"+Hf+"]",TS="[^"+Hf.replace("\\.","")+"]",AS=/((?:WC+[\/:])*)/.source.replace("WC",Gf),RS=/(WCOD+)?/.source.replace("WCOD",TS),CS=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",Gf),PS=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",Gf),IS=new RegExp("^"+AS+RS+CS+PS+"$"),LS=["material","materials","bones","map"],lf=class{constructor(t,e,n){let s=n||Ke.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(t,e)}setValue(t,e){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].unbind()}},Ke=class i{constructor(t,e,n){this.path=e,this.parsedPath=n||i.parseTrackName(e),this.node=i.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,n){return t&&t.isAnimationObjectGroup?new i.Composite(t,e,n):new i(t,e,n)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(ES,"")}static parseTrackName(t){let e=IS.exec(t);if(e===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+t);let n={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);LS.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+t);return n}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let n=t.skeleton.getBoneByName(e);if(n!==void 0)return n}if(t.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let l=n(a.children);if(l)return l}return null},s=n(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)t[e++]=n[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,n=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=i.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){Yt("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=e.objectIndex;switch(n){case"materials":if(!t.material){te("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){te("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){te("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let h=0;h<t.length;h++)if(t[h].name===c){c=h;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){te("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){te("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[n]===void 0){te("PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[n]}if(c!==void 0){if(t[c]===void 0){te("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[c]}}let o=t[s];if(o===void 0){let c=e.nodeName;te("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?a=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){te("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){te("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};Ke.Composite=lf;Ke.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};Ke.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};Ke.prototype.GetterByBindingType=[Ke.prototype._getValue_direct,Ke.prototype._getValue_array,Ke.prototype._getValue_arrayElement,Ke.prototype._getValue_toArray];Ke.prototype.SetterByBindingTypeAndVersioning=[[Ke.prototype._setValue_direct,Ke.prototype._setValue_direct_setNeedsUpdate,Ke.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[Ke.prototype._setValue_array,Ke.prototype._setValue_array_setNeedsUpdate,Ke.prototype._setValue_array_setMatrixWorldNeedsUpdate],[Ke.prototype._setValue_arrayElement,Ke.prototype._setValue_arrayElement_setNeedsUpdate,Ke.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[Ke.prototype._setValue_fromArray,Ke.prototype._setValue_fromArray_setNeedsUpdate,Ke.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var eI=new Float32Array(1);var Z0=new Ve,ir=class{constructor(t,e,n=0,s=1/0){this.ray=new ws(t,e),this.near=n,this.far=s,this.camera=null,this.layers=new Lo,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(t,e){this.ray.set(t,e)}setFromCamera(t,e){e.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(t.x,t.y,.5).unproject(e).sub(this.ray.origin).normalize(),this.camera=e):e.isOrthographicCamera?(this.ray.origin.set(t.x,t.y,e.projectionMatrix.elements[14]).unproject(e),this.ray.direction.set(0,0,-1).transformDirection(e.matrixWorld),this.camera=e):te("Raycaster: Unsupported camera type: "+e.type)}setFromXRController(t){return Z0.identity().extractRotation(t.matrixWorld),this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(Z0),this}intersectObject(t,e=!0,n=[]){return cf(t,this,n,e),n.sort(K0),n}intersectObjects(t,e=!0,n=[]){for(let s=0,r=t.length;s<r;s++)cf(t[s],this,n,e);return n.sort(K0),n}};function K0(i,t){return i.distance-t.distance}function cf(i,t,e,n){let s=!0;if(i.layers.test(t.layers)&&i.raycast(t,e)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)cf(r[o],t,e,!0)}}var sr=class{constructor(t=1,e=0,n=0){this.radius=t,this.phi=e,this.theta=n}set(t,e,n){return this.radius=t,this.phi=e,this.theta=n,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=ge(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,n){return this.radius=Math.sqrt(t*t+e*e+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,n),this.phi=Math.acos(ge(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var hf=class{static{this.prototype.isMatrix2=!0}constructor(t,e,n,s){this.elements=[1,0,0,1],t!==void 0&&this.set(t,e,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(t,e=0){for(let n=0;n<4;n++)this.elements[n]=t[n+e];return this}set(t,e,n,s){let r=this.elements;return r[0]=t,r[2]=e,r[1]=n,r[3]=s,this}};var J0=new H,Tc,Jd,Wa=class extends Rn{constructor(t=new H(0,0,1),e=new H(0,0,0),n=1,s=16776960,r=n*.2,o=r*.2){super(),this.type="ArrowHelper",Tc===void 0&&(Tc=new Fe,Tc.setAttribute("position",new Ee([0,0,0,0,1,0],3)),Jd=new Wc(.5,1,5,1),Jd.translate(0,-.5,0)),this.position.copy(e),this.line=new No(Tc,new Hi({color:s,toneMapped:!1})),this.line.matrixAutoUpdate=!1,this.add(this.line),this.cone=new Ie(Jd,new Wn({color:s,toneMapped:!1})),this.cone.matrixAutoUpdate=!1,this.add(this.cone),this.setDirection(t),this.setLength(n,r,o)}setDirection(t){if(t.y>.99999)this.quaternion.set(0,0,0,1);else if(t.y<-.99999)this.quaternion.set(1,0,0,0);else{J0.set(t.z,0,-t.x).normalize();let e=Math.acos(t.y);this.quaternion.setFromAxisAngle(J0,e)}}setLength(t,e=t*.2,n=e*.2){this.line.scale.set(1,Math.max(1e-4,t-e),1),this.line.updateMatrix(),this.cone.scale.set(n,e,n),this.cone.position.y=t,this.cone.updateMatrix()}setColor(t){this.line.material.color.set(t),this.cone.material.color.set(t)}copy(t){return super.copy(t,!1),this.line.copy(t.line),this.cone.copy(t.cone),this}dispose(){super.dispose(),this.line.geometry.dispose(),this.line.material.dispose(),this.cone.geometry.dispose(),this.cone.material.dispose()}};var $a=class extends Bi{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(t){this.domElement!==null&&this.disconnect(),this.domElement=t}disconnect(){}dispose(){}update(){}};function Vf(i,t,e,n){let s=DS(n);switch(e){case Cf:return i*t;case If:return i*t/s.components*s.byteLength;case fh:return i*t/s.components*s.byteLength;case lr:return i*t*2/s.components*s.byteLength;case ph:return i*t*2/s.components*s.byteLength;case Pf:return i*t*3/s.components*s.byteLength;case Cn:return i*t*4/s.components*s.byteLength;case mh:return i*t*4/s.components*s.byteLength;case qa:case Ya:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case Za:case Ka:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case _h:case vh:return Math.max(i,16)*Math.max(t,8)/4;case gh:case yh:return Math.max(i,8)*Math.max(t,8)/2;case xh:case bh:case Sh:case Mh:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case wh:case Ja:case Eh:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Th:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Ah:return Math.floor((i+4)/5)*Math.floor((t+3)/4)*16;case Rh:return Math.floor((i+4)/5)*Math.floor((t+4)/5)*16;case Ch:return Math.floor((i+5)/6)*Math.floor((t+4)/5)*16;case Ph:return Math.floor((i+5)/6)*Math.floor((t+5)/6)*16;case Ih:return Math.floor((i+7)/8)*Math.floor((t+4)/5)*16;case Lh:return Math.floor((i+7)/8)*Math.floor((t+5)/6)*16;case Dh:return Math.floor((i+7)/8)*Math.floor((t+7)/8)*16;case Nh:return Math.floor((i+9)/10)*Math.floor((t+4)/5)*16;case Uh:return Math.floor((i+9)/10)*Math.floor((t+5)/6)*16;case Fh:return Math.floor((i+9)/10)*Math.floor((t+7)/8)*16;case Oh:return Math.floor((i+9)/10)*Math.floor((t+9)/10)*16;case kh:return Math.floor((i+11)/12)*Math.floor((t+9)/10)*16;case Bh:return Math.floor((i+11)/12)*Math.floor((t+11)/12)*16;case zh:case Hh:case Gh:return Math.ceil(i/4)*Math.ceil(t/4)*16;case Vh:case Wh:return Math.ceil(i/4)*Math.ceil(t/4)*8;case ja:case $h:return Math.ceil(i/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function DS(i){switch(i){case ci:case Ef:return{byteLength:1,components:1};case Go:case Tf:case Vi:return{byteLength:2,components:1};case uh:case dh:return{byteLength:2,components:4};case Gi:case hh:case Jn:return{byteLength:4,components:1};case Af:case Rf:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Yt("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function dy(){let i=null,t=!1,e=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),e(r,o)}return{start:function(){t!==!0&&e!==null&&i!==null&&(n=i.requestAnimationFrame(s),t=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){i=r}}}function zS(i){let t=new WeakMap;function e(a,l){let c=a.array,h=a.usage,d=c.byteLength,u=i.createBuffer();i.bindBuffer(l,u),i.bufferData(l,c,h),a.onUploadCallback();let p;if(c instanceof Float32Array)p=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)p=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?p=i.HALF_FLOAT:p=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)p=i.SHORT;else if(c instanceof Uint32Array)p=i.UNSIGNED_INT;else if(c instanceof Int32Array)p=i.INT;else if(c instanceof Int8Array)p=i.BYTE;else if(c instanceof Uint8Array)p=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)p=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:u,type:p,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:d}}function n(a,l,c){let h=l.array,d=l.updateRanges;if(i.bindBuffer(c,a),d.length===0)i.bufferSubData(c,0,h);else{d.sort((p,m)=>p.start-m.start);let u=0;for(let p=1;p<d.length;p++){let m=d[u],x=d[p];x.start<=m.start+m.count+1?m.count=Math.max(m.count,x.start+x.count-m.start):(++u,d[u]=x)}d.length=u+1;for(let p=0,m=d.length;p<m;p++){let x=d[p];i.bufferSubData(c,x.start*h.BYTES_PER_ELEMENT,h,x.start,x.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=t.get(a);l&&(i.deleteBuffer(l.buffer),t.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=t.get(a);(!h||h.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=t.get(a);if(c===void 0)t.set(a,e(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var HS=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,GS=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,VS=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,WS=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,$S=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,XS=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,qS=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,YS=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,ZS=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,KS=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,JS=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,jS=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,QS=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,tM=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,eM=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,nM=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,iM=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,sM=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,rM=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,oM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,aM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,lM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,cM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,hM=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,uM=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,dM=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,fM=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,pM=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,mM=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,gM="gl_FragColor = linearToOutputTexel( gl_FragColor );",_M=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,yM=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,vM=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,xM=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,bM=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,wM=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,SM=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,MM=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,EM=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,TM=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,AM=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,RM=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,CM=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,PM=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,IM=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,LM=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,DM=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,NM=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,UM=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,FM=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,OM=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,kM=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,BM=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,zM=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,HM=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,GM=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,VM=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,WM=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,$M=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,XM=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,qM=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,YM=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,ZM=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,KM=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,JM=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,jM=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,QM=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,tE=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,eE=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,nE=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,iE=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,sE=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,rE=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,oE=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,aE=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,lE=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,cE=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,hE=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,uE=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,dE=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,fE=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,pE=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,mE=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,gE=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,_E=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,yE=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,vE=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,xE=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,bE=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,wE=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,SE=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,ME=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,EE=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,TE=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,AE=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,RE=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,CE=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,PE=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,IE=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,LE=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,DE=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,NE=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,UE=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,FE=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,OE=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,kE=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,BE=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,zE=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,HE=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,GE=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,VE=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,WE=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,$E=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,XE=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,qE=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,YE=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,ZE=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,KE=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,JE=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,jE=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,QE=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,tT=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,eT=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,nT=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,iT=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,sT=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,rT=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,oT=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,aT=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,lT=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,cT=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,hT=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,uT=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,dT=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,fT=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,pT=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,mT=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,gT=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,_T=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,yT=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,vT=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,ue={alphahash_fragment:HS,alphahash_pars_fragment:GS,alphamap_fragment:VS,alphamap_pars_fragment:WS,alphatest_fragment:$S,alphatest_pars_fragment:XS,aomap_fragment:qS,aomap_pars_fragment:YS,batching_pars_vertex:ZS,batching_vertex:KS,begin_vertex:JS,beginnormal_vertex:jS,bsdfs:QS,iridescence_fragment:tM,bumpmap_pars_fragment:eM,clipping_planes_fragment:nM,clipping_planes_pars_fragment:iM,clipping_planes_pars_vertex:sM,clipping_planes_vertex:rM,color_fragment:oM,color_pars_fragment:aM,color_pars_vertex:lM,color_vertex:cM,common:hM,defaultnormal_vertex:uM,displacementmap_pars_vertex:dM,displacementmap_vertex:fM,emissivemap_fragment:pM,emissivemap_pars_fragment:mM,colorspace_fragment:gM,colorspace_pars_fragment:_M,envmap_fragment:yM,envmap_common_pars_fragment:vM,envmap_pars_fragment:xM,envmap_pars_vertex:bM,envmap_physical_pars_fragment:LM,envmap_vertex:wM,fog_vertex:SM,fog_pars_vertex:MM,fog_fragment:EM,fog_pars_fragment:TM,gradientmap_pars_fragment:AM,lightmap_pars_fragment:RM,lights_lambert_fragment:CM,lights_lambert_pars_fragment:PM,lights_pars_begin:IM,lights_toon_fragment:DM,lights_toon_pars_fragment:NM,lights_phong_fragment:UM,lights_phong_pars_fragment:FM,lights_physical_fragment:OM,lights_physical_pars_fragment:kM,lights_fragment_begin:BM,lights_fragment_maps:zM,lights_fragment_end:HM,lightprobes_pars_fragment:GM,logdepthbuf_fragment:VM,logdepthbuf_pars_fragment:WM,logdepthbuf_pars_vertex:$M,logdepthbuf_vertex:XM,map_fragment:qM,map_pars_fragment:YM,map_particle_fragment:ZM,map_particle_pars_fragment:KM,metalnessmap_fragment:JM,metalnessmap_pars_fragment:jM,morphinstance_vertex:QM,morphcolor_vertex:tE,morphnormal_vertex:eE,morphtarget_pars_vertex:nE,morphtarget_vertex:iE,normal_fragment_begin:sE,normal_fragment_maps:rE,normal_pars_fragment:oE,normal_pars_vertex:aE,normal_vertex:lE,normalmap_pars_fragment:cE,clearcoat_normal_fragment_begin:hE,clearcoat_normal_fragment_maps:uE,clearcoat_pars_fragment:dE,iridescence_pars_fragment:fE,opaque_fragment:pE,packing:mE,premultiplied_alpha_fragment:gE,project_vertex:_E,dithering_fragment:yE,dithering_pars_fragment:vE,roughnessmap_fragment:xE,roughnessmap_pars_fragment:bE,shadowmap_pars_fragment:wE,shadowmap_pars_vertex:SE,shadowmap_vertex:ME,shadowmask_pars_fragment:EE,skinbase_vertex:TE,skinning_pars_vertex:AE,skinning_vertex:RE,skinnormal_vertex:CE,specularmap_fragment:PE,specularmap_pars_fragment:IE,tonemapping_fragment:LE,tonemapping_pars_fragment:DE,transmission_fragment:NE,transmission_pars_fragment:UE,uv_pars_fragment:FE,uv_pars_vertex:OE,uv_vertex:kE,worldpos_vertex:BE,background_vert:zE,background_frag:HE,backgroundCube_vert:GE,backgroundCube_frag:VE,cube_vert:WE,cube_frag:$E,depth_vert:XE,depth_frag:qE,distance_vert:YE,distance_frag:ZE,equirect_vert:KE,equirect_frag:JE,linedashed_vert:jE,linedashed_frag:QE,meshbasic_vert:tT,meshbasic_frag:eT,meshlambert_vert:nT,meshlambert_frag:iT,meshmatcap_vert:sT,meshmatcap_frag:rT,meshnormal_vert:oT,meshnormal_frag:aT,meshphong_vert:lT,meshphong_frag:cT,meshphysical_vert:hT,meshphysical_frag:uT,meshtoon_vert:dT,meshtoon_frag:fT,points_vert:pT,points_frag:mT,shadow_vert:gT,shadow_frag:_T,sprite_vert:yT,sprite_frag:vT},Dt={common:{diffuse:{value:new Zt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new ne},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new ne}},envmap:{envMap:{value:null},envMapRotation:{value:new ne},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new ne}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new ne}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new ne},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new ne},normalScale:{value:new Vt(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new ne},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new ne}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new ne}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new ne}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Zt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Zt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0},uvTransform:{value:new ne}},sprite:{diffuse:{value:new Zt(16777215)},opacity:{value:1},center:{value:new Vt(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new ne},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0}}},is={basic:{uniforms:jn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.fog]),vertexShader:ue.meshbasic_vert,fragmentShader:ue.meshbasic_frag},lambert:{uniforms:jn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},envMapIntensity:{value:1}}]),vertexShader:ue.meshlambert_vert,fragmentShader:ue.meshlambert_frag},phong:{uniforms:jn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},specular:{value:new Zt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:ue.meshphong_vert,fragmentShader:ue.meshphong_frag},standard:{uniforms:jn([Dt.common,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.roughnessmap,Dt.metalnessmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:ue.meshphysical_vert,fragmentShader:ue.meshphysical_frag},toon:{uniforms:jn([Dt.common,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.gradientmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)}}]),vertexShader:ue.meshtoon_vert,fragmentShader:ue.meshtoon_frag},matcap:{uniforms:jn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,{matcap:{value:null}}]),vertexShader:ue.meshmatcap_vert,fragmentShader:ue.meshmatcap_frag},points:{uniforms:jn([Dt.points,Dt.fog]),vertexShader:ue.points_vert,fragmentShader:ue.points_frag},dashed:{uniforms:jn([Dt.common,Dt.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:ue.linedashed_vert,fragmentShader:ue.linedashed_frag},depth:{uniforms:jn([Dt.common,Dt.displacementmap]),vertexShader:ue.depth_vert,fragmentShader:ue.depth_frag},normal:{uniforms:jn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,{opacity:{value:1}}]),vertexShader:ue.meshnormal_vert,fragmentShader:ue.meshnormal_frag},sprite:{uniforms:jn([Dt.sprite,Dt.fog]),vertexShader:ue.sprite_vert,fragmentShader:ue.sprite_frag},background:{uniforms:{uvTransform:{value:new ne},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:ue.background_vert,fragmentShader:ue.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new ne}},vertexShader:ue.backgroundCube_vert,fragmentShader:ue.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:ue.cube_vert,fragmentShader:ue.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:ue.equirect_vert,fragmentShader:ue.equirect_frag},distance:{uniforms:jn([Dt.common,Dt.displacementmap,{referencePosition:{value:new H},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:ue.distance_vert,fragmentShader:ue.distance_frag},shadow:{uniforms:jn([Dt.lights,Dt.fog,{color:{value:new Zt(0)},opacity:{value:1}}]),vertexShader:ue.shadow_vert,fragmentShader:ue.shadow_frag}};is.physical={uniforms:jn([is.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new ne},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new ne},clearcoatNormalScale:{value:new Vt(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new ne},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new ne},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new ne},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new ne},sheen:{value:0},sheenColor:{value:new Zt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new ne},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new ne},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new ne},transmissionSamplerSize:{value:new Vt},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new ne},attenuationDistance:{value:0},attenuationColor:{value:new Zt(0)},specularColor:{value:new Zt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new ne},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new ne},anisotropyVector:{value:new Vt},anisotropyMap:{value:null},anisotropyMapTransform:{value:new ne}}]),vertexShader:ue.meshphysical_vert,fragmentShader:ue.meshphysical_frag};var Xh={r:0,b:0,g:0},xT=new Ve,fy=new ne;fy.set(-1,0,0,0,1,0,0,0,1);function bT(i,t,e,n,s,r){let o=new Zt(0),a=s===!0?0:1,l,c,h=null,d=0,u=null;function p(b){let S=b.isScene===!0?b.background:null;if(S&&S.isTexture){let y=b.backgroundBlurriness>0;S=t.get(S,y)}return S}function m(b){let S=!1,y=p(b);y===null?g(o,a):y&&y.isColor&&(g(y,1),S=!0);let C=i.xr.getEnvironmentBlendMode();C==="additive"?e.buffers.color.setClear(0,0,0,1,r):C==="alpha-blend"&&e.buffers.color.setClear(0,0,0,0,r),(i.autoClear||S)&&(e.buffers.depth.setTest(!0),e.buffers.depth.setMask(!0),e.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function x(b,S){let y=p(S);y&&y.isCubeTexture?(c===void 0&&(c=new Ie(new Ks(1,1,1),new Ci({name:"BackgroundCubeMaterial",uniforms:Fr(is.backgroundCube.uniforms),vertexShader:is.backgroundCube.vertexShader,fragmentShader:is.backgroundCube.fragmentShader,side:li,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(C,E,v){this.matrixWorld.copyPosition(v.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=y,c.material.uniforms.backgroundBlurriness.value=S.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=S.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(xT.makeRotationFromEuler(S.backgroundRotation)).transpose(),y.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(fy),c.material.toneMapped=xe.getTransfer(y.colorSpace)!==Pe,(h!==y||d!==y.version||u!==i.toneMapping)&&(c.material.needsUpdate=!0,h=y,d=y.version,u=i.toneMapping),c.layers.enableAll(),b.unshift(c,c.geometry,c.material,0,0,null)):y&&y.isTexture&&(l===void 0&&(l=new Ie(new Es(2,2),new Ci({name:"BackgroundMaterial",uniforms:Fr(is.background.uniforms),vertexShader:is.background.vertexShader,fragmentShader:is.background.fragmentShader,side:ar,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=y,l.material.uniforms.backgroundIntensity.value=S.backgroundIntensity,l.material.toneMapped=xe.getTransfer(y.colorSpace)!==Pe,y.matrixAutoUpdate===!0&&y.updateMatrix(),l.material.uniforms.uvTransform.value.copy(y.matrix),(h!==y||d!==y.version||u!==i.toneMapping)&&(l.material.needsUpdate=!0,h=y,d=y.version,u=i.toneMapping),l.layers.enableAll(),b.unshift(l,l.geometry,l.material,0,0,null))}function g(b,S){b.getRGB(Xh,zf(i)),e.buffers.color.setClear(Xh.r,Xh.g,Xh.b,S,r)}function _(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(b,S=1){o.set(b),a=S,g(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(b){a=b,g(o,a)},render:m,addToRenderList:x,dispose:_}}function wT(i,t){let e=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=u(null),r=s,o=!1;function a(D,B,G,N,W){let q=!1,V=d(D,N,G,B);r!==V&&(r=V,c(r.object)),q=p(D,N,G,W),q&&m(D,N,G,W),W!==null&&t.update(W,i.ELEMENT_ARRAY_BUFFER),(q||o)&&(o=!1,y(D,B,G,N),W!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,t.get(W).buffer))}function l(){return i.createVertexArray()}function c(D){return i.bindVertexArray(D)}function h(D){return i.deleteVertexArray(D)}function d(D,B,G,N){let W=N.wireframe===!0,q=n[B.id];q===void 0&&(q={},n[B.id]=q);let V=D.isInstancedMesh===!0?D.id:0,lt=q[V];lt===void 0&&(lt={},q[V]=lt);let Z=lt[G.id];Z===void 0&&(Z={},lt[G.id]=Z);let j=Z[W];return j===void 0&&(j=u(l()),Z[W]=j),j}function u(D){let B=[],G=[],N=[];for(let W=0;W<e;W++)B[W]=0,G[W]=0,N[W]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:B,enabledAttributes:G,attributeDivisors:N,object:D,attributes:{},index:null}}function p(D,B,G,N){let W=r.attributes,q=B.attributes,V=0,lt=G.getAttributes();for(let Z in lt)if(lt[Z].location>=0){let et=W[Z],dt=q[Z];if(dt===void 0&&(Z==="instanceMatrix"&&D.instanceMatrix&&(dt=D.instanceMatrix),Z==="instanceColor"&&D.instanceColor&&(dt=D.instanceColor)),et===void 0||et.attribute!==dt||dt&&et.data!==dt.data)return!0;V++}return r.attributesNum!==V||r.index!==N}function m(D,B,G,N){let W={},q=B.attributes,V=0,lt=G.getAttributes();for(let Z in lt)if(lt[Z].location>=0){let et=q[Z];et===void 0&&(Z==="instanceMatrix"&&D.instanceMatrix&&(et=D.instanceMatrix),Z==="instanceColor"&&D.instanceColor&&(et=D.instanceColor));let dt={};dt.attribute=et,et&&et.data&&(dt.data=et.data),W[Z]=dt,V++}r.attributes=W,r.attributesNum=V,r.index=N}function x(){let D=r.newAttributes;for(let B=0,G=D.length;B<G;B++)D[B]=0}function g(D){_(D,0)}function _(D,B){let G=r.newAttributes,N=r.enabledAttributes,W=r.attributeDivisors;G[D]=1,N[D]===0&&(i.enableVertexAttribArray(D),N[D]=1),W[D]!==B&&(i.vertexAttribDivisor(D,B),W[D]=B)}function b(){let D=r.newAttributes,B=r.enabledAttributes;for(let G=0,N=B.length;G<N;G++)B[G]!==D[G]&&(i.disableVertexAttribArray(G),B[G]=0)}function S(D,B,G,N,W,q,V){V===!0?i.vertexAttribIPointer(D,B,G,W,q):i.vertexAttribPointer(D,B,G,N,W,q)}function y(D,B,G,N){x();let W=N.attributes,q=G.getAttributes(),V=B.defaultAttributeValues;for(let lt in q){let Z=q[lt];if(Z.location>=0){let j=W[lt];if(j===void 0&&(lt==="instanceMatrix"&&D.instanceMatrix&&(j=D.instanceMatrix),lt==="instanceColor"&&D.instanceColor&&(j=D.instanceColor)),j!==void 0){let et=j.normalized,dt=j.itemSize,ut=t.get(j);if(ut===void 0)continue;let tt=ut.buffer,gt=ut.type,vt=ut.bytesPerElement,Rt=gt===i.INT||gt===i.UNSIGNED_INT||j.gpuType===hh;if(j.isInterleavedBufferAttribute){let St=j.data,$t=St.isInterleavedBuffer===!0?St.stride:St.itemSize,re=j.offset;if(St.isInstancedInterleavedBuffer||St.isInstancedBufferAttribute){for(let Gt=0;Gt<Z.locationSize;Gt++)_(Z.location+Gt,St.meshPerAttribute);D.isInstancedMesh!==!0&&N._maxInstanceCount===void 0&&(N._maxInstanceCount=St.meshPerAttribute*St.count)}else for(let Gt=0;Gt<Z.locationSize;Gt++)g(Z.location+Gt);i.bindBuffer(i.ARRAY_BUFFER,tt);for(let Gt=0;Gt<Z.locationSize;Gt++)S(Z.location+Gt,dt/Z.locationSize,gt,et,$t*vt,(re+dt/Z.locationSize*Gt)*vt,Rt)}else{if(j.isInstancedBufferAttribute){for(let St=0;St<Z.locationSize;St++)_(Z.location+St,j.meshPerAttribute);D.isInstancedMesh!==!0&&N._maxInstanceCount===void 0&&(N._maxInstanceCount=j.meshPerAttribute*j.count)}else for(let St=0;St<Z.locationSize;St++)g(Z.location+St);i.bindBuffer(i.ARRAY_BUFFER,tt);for(let St=0;St<Z.locationSize;St++)S(Z.location+St,dt/Z.locationSize,gt,et,dt*vt,dt/Z.locationSize*St*vt,Rt)}}else if(V!==void 0){let et=V[lt];if(et!==void 0)switch(et.length){case 2:i.vertexAttrib2fv(Z.location,et);break;case 3:i.vertexAttrib3fv(Z.location,et);break;case 4:i.vertexAttrib4fv(Z.location,et);break;default:i.vertexAttrib1fv(Z.location,et)}}}}b()}function C(){F();for(let D in n){let B=n[D];for(let G in B){let N=B[G];for(let W in N){let q=N[W];for(let V in q)h(q[V].object),delete q[V];delete N[W]}}delete n[D]}}function E(D){if(n[D.id]===void 0)return;let B=n[D.id];for(let G in B){let N=B[G];for(let W in N){let q=N[W];for(let V in q)h(q[V].object),delete q[V];delete N[W]}}delete n[D.id]}function v(D){for(let B in n){let G=n[B];for(let N in G){let W=G[N];if(W[D.id]===void 0)continue;let q=W[D.id];for(let V in q)h(q[V].object),delete q[V];delete W[D.id]}}}function T(D){for(let B in n){let G=n[B],N=D.isInstancedMesh===!0?D.id:0,W=G[N];if(W!==void 0){for(let q in W){let V=W[q];for(let lt in V)h(V[lt].object),delete V[lt];delete W[q]}delete G[N],Object.keys(G).length===0&&delete n[B]}}}function F(){L(),o=!0,r!==s&&(r=s,c(r.object))}function L(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:F,resetDefaultState:L,dispose:C,releaseStatesOfGeometry:E,releaseStatesOfObject:T,releaseStatesOfProgram:v,initAttributes:x,enableAttribute:g,disableUnusedAttributes:b}}function ST(i,t,e){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),e.update(c,n,1)}function o(l,c,h){h!==0&&(i.drawArraysInstanced(n,l,c,h),e.update(c,n,h))}function a(l,c,h){if(h===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let u=0;for(let p=0;p<h;p++)u+=c[p];e.update(u,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function MT(i,t,e,n){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let v=t.get("EXT_texture_filter_anisotropic");s=i.getParameter(v.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(v){return!(v!==Cn&&n.convert(v)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(v){let T=v===Vi&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(v!==ci&&v!==Jn&&!T&&n.convert(v)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(v){if(v==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";v="mediump"}return v==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=e.precision!==void 0?e.precision:"highp",h=l(c);h!==c&&(Yt("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let d=e.reversedDepthBuffer===!0&&t.has("EXT_clip_control"),u=e.logarithmicDepthBuffer===!0&&d===!1;e.reversedDepthBuffer===!0&&d===!1&&Yt("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),e.logarithmicDepthBuffer===!0&&d===!0&&Yt("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let p=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),m=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),x=i.getParameter(i.MAX_TEXTURE_SIZE),g=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),_=i.getParameter(i.MAX_VERTEX_ATTRIBS),b=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),S=i.getParameter(i.MAX_VARYING_VECTORS),y=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),C=i.getParameter(i.MAX_SAMPLES),E=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:u,reversedDepthBuffer:d,maxTextures:p,maxVertexTextures:m,maxTextureSize:x,maxCubemapSize:g,maxAttributes:_,maxVertexUniforms:b,maxVaryings:S,maxFragmentUniforms:y,maxSamples:C,samples:E}}function ET(i){let t=this,e=null,n=0,s=!1,r=!1,o=new Gn,a=new ne,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(d,u){let p=d.length!==0||u||n!==0||s;return s=u,n=d.length,p},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(d,u){e=h(d,u,0)},this.setState=function(d,u,p){let m=d.clippingPlanes,x=d.clipIntersection,g=d.clipShadows,_=i.get(d);if(!s||m===null||m.length===0||r&&!g)r?h(null):c();else{let b=r?0:n,S=b*4,y=_.clippingState||null;l.value=y,y=h(m,u,S,p);for(let C=0;C!==S;++C)y[C]=e[C];_.clippingState=y,this.numIntersection=x?this.numPlanes:0,this.numPlanes+=b}};function c(){l.value!==e&&(l.value=e,l.needsUpdate=n>0),t.numPlanes=n,t.numIntersection=0}function h(d,u,p,m){let x=d!==null?d.length:0,g=null;if(x!==0){if(g=l.value,m!==!0||g===null){let _=p+x*4,b=u.matrixWorldInverse;a.getNormalMatrix(b),(g===null||g.length<_)&&(g=new Float32Array(_));for(let S=0,y=p;S!==x;++S,y+=4)o.copy(d[S]).applyMatrix4(b,a),o.normal.toArray(g,y),g[y+3]=o.constant}l.value=g,l.needsUpdate=!0}return t.numPlanes=x,t.numIntersection=0,g}}var nl=class extends xi{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let n={width:t,height:t,depth:1},s=[n,n,n,n,n,n];this.texture=new Pa(s),this._setTextureOptions(e),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new Ks(5,5,5),r=new Ci({name:"CubemapFromEquirect",uniforms:Fr(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:li,blending:Ir});r.uniforms.tEquirect.value=e;let o=new Ie(s,r),a=e.minFilter;return e.minFilter===Ts&&(e.minFilter=Vn),new ko(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e=!0,n=!0,s=!0){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,n,s);t.setRenderTarget(r)}},$_=256,TT=3,AT=20,py=256,my=16,RT=3,CT=new H,PT=new Zt,Yh=class i{constructor(t){this._renderer=t,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new ko(1,10,null),this._boxMesh=new Ie(new Ks(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(t,e=0,n=.1,s=100,r={}){let{size:o=256,position:a=CT}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),h=this._getSourceTarget(!0);e>0&&(h.texture.mipmapsAutoUpdate=!1);let d=l.autoClear,u=l.autoClearColor,p=l.autoClearDepth,m=l.autoClearStencil,x=t.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,x===null&&(t.background=l.getClearColor(PT));let g=new ko(n,s,h);return g.position.copy(a),g.update(l,t),l.autoClear=d,l.autoClearColor=u,l.autoClearDepth=p,l.autoClearStencil=m,t.background=x,e>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,e)),this._applyPMREM(c),c}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=Y_(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=q_(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(t,e){return e>0?1-Math.sqrt(1-t/e):0}_setSize(t){this._cubeSize=Math.max($_,kf(t))}_fromTexture(t,e){t.mapping===Dr||t.mapping===Ho?this._setSize(t.image.length===0?$_:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4);let n=e||this._allocateTarget();return this._textureToCubemap(t),this._applyPMREM(n),n}_allocateTarget(){let t=this._cubeSize,e=X_(t,!1,!1),n=Math.log2(t)-TT;for(let s=0;s<=n;s++)e.texture.mipmaps.push({width:t>>s,height:t>>s});return e.texture.name="PMREM",e.texture.isPMREMTexture=!0,e}_getSourceTarget(t=!1){let e=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==e||t&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=X_(e,!0,t)),this._sourceTarget}_compileMaterial(t){this._boxMesh.material=t,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(t,e,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=t,r.activeMipmapLevel=e;let o=t.width>>e;t.viewport.set(0,0,o,o),r.update(this._renderer,s),t.viewport.set(0,0,t.width,t.height)}_textureToCubemap(t){let e;t.mapping===Dr||t.mapping===Ho?(this._cubemapMaterial===null&&(this._cubemapMaterial=Y_()),e=this._cubemapMaterial,e.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=q_()),e=this._equirectMaterial),e.uniforms.envMap.value=t,this._renderCube(this._getSourceTarget(),0,e)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=IT(),this._integrationMaterial=LT());let e=this._cubeSize,n=t.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(e/my);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-RT)r.roughness.value=a,this._renderCube(t,o,this._integrationMaterial);else{let l=a>0?Math.log2(e)+.5*Math.log2(6/(py*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(t,o,this._ggxMaterial)}}}_blur(t,e){this._blurMaterial===null&&(this._blurMaterial=DT());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(e,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(t,0,n),s.envMap.value=t.texture,this._renderCube(r,0,n)}};function X_(i,t,e){return new nl(i,{minFilter:Ts,generateMipmaps:t,type:Vi,colorSpace:xa,depthBuffer:e})}function il(i,t,e){return new Ci({name:i,uniforms:t,vertexShader:ue.cube_vert,fragmentShader:e,side:li,blending:Ir,depthTest:!1,depthWrite:!1})}function IT(){return il("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${py}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function LT(){return il("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:my}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function DT(){return il("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${AT}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function q_(){return il("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function Y_(){return il("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function NT(i){let t=new WeakMap,e=new WeakMap,n=null;function s(u,p=!1){return u==null?null:p?o(u):r(u)}function r(u){if(u&&u.isTexture){let p=u.mapping;if(p===ah||p===lh)if(t.has(u)){let m=t.get(u).texture;return a(m,u.mapping)}else{let m=u.image;if(m&&m.height>0){let x=new nl(m.height);return x.fromEquirectangularTexture(i,u),t.set(u,x),u.addEventListener("dispose",c),a(x.texture,u.mapping)}else return null}}return u}function o(u){if(u&&u.isTexture&&u.isPMREMTexture!==!0){let p=u.mapping,m=p===ah||p===lh,x=p===Dr||p===Ho;if(m||x){let g=e.get(u),_=g!==void 0?g.texture.pmremVersion:0;if(u.isRenderTargetTexture&&u.pmremVersion!==_)return n===null&&(n=new Yh(i)),g=m?n.fromEquirectangular(u,g):n.fromCubemap(u,g),g.texture.pmremVersion=u.pmremVersion,e.set(u,g),g.texture;if(g!==void 0)return g.texture;{let b=u.image;return m&&b&&b.height>0||x&&b&&l(b)?(n===null&&(n=new Yh(i)),g=m?n.fromEquirectangular(u):n.fromCubemap(u),g.texture.pmremVersion=u.pmremVersion,e.set(u,g),u.addEventListener("dispose",h),g.texture):null}}}return u}function a(u,p){return p===ah?u.mapping=Dr:p===lh&&(u.mapping=Ho),u}function l(u){let p=0,m=6;for(let x=0;x<m;x++)u[x]!==void 0&&p++;return p===m}function c(u){let p=u.target;p.removeEventListener("dispose",c);let m=t.get(p);m!==void 0&&(t.delete(p),m.dispose())}function h(u){let p=u.target;p.removeEventListener("dispose",h);let m=e.get(p);m!==void 0&&(e.delete(p),m.dispose())}function d(){t=new WeakMap,e=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:d}}function UT(i){let t={};function e(n){if(t[n]!==void 0)return t[n];let s=i.getExtension(n);return t[n]=s,s}return{has:function(n){return e(n)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(n){let s=e(n);return s===null&&ga("WebGLRenderer: "+n+" extension not supported."),s}}}function FT(i,t,e,n){let s={},r=new WeakMap,o=new FinalizationRegistry(m=>delete s[m]);function a(m){l(m.target)}function l(m){m.index!==null&&t.remove(m.index);for(let g in m.attributes)t.remove(m.attributes[g]);m.removeEventListener("dispose",a),delete s[m.id],o.unregister(m);let x=r.get(m);x&&(t.remove(x),r.delete(m)),n.releaseStatesOfGeometry(m),m.isInstancedBufferGeometry===!0&&delete m._maxInstanceCount,e.memory.geometries--}function c(m,x){return s[x.id]!==void 0||(x.addEventListener("dispose",a),s[x.id]=new WeakRef(x),o.register(x,x.id,x),e.memory.geometries++),x}function h(m){let x=m.attributes;for(let g in x)t.update(x[g],i.ARRAY_BUFFER)}function d(m){let x=m.index,g=m.attributes.position,_=0;if(g===void 0)return;let b=x!==null?x.array.length:g.array.length/3-1,S=g.count>=65535?Aa:Ta,y=new S(Math.ceil(b/3)*6,1),C=y.array;if(x!==null){let v=x.array;_=x.version;for(let T=0,F=0;T<b;T+=3){let L=v[T+0],D=v[T+1],B=v[T+2];C[F++]=L,C[F++]=D,C[F++]=D,C[F++]=B,C[F++]=B,C[F++]=L}}else{_=g.version;for(let v=0,T=0;v<b;v+=3){let F=v+0,L=v+1,D=v+2;C[T++]=F,C[T++]=L,C[T++]=L,C[T++]=D,C[T++]=D,C[T++]=F}}y.version=_;let E=r.get(m);E&&t.remove(E),r.set(m,y)}function u(m){let x=r.get(m);if(x){let g=m.index;g!==null&&x.version<g.version&&d(m)}else d(m);return r.get(m)}function p(){for(let m in s){let x=s[m].deref();x!==void 0&&l(x)}}return{get:c,update:h,getWireframeAttribute:u,dispose:p}}function OT(i,t,e){let n;function s(d){n=d}let r,o;function a(d){r=d.type,o=d.bytesPerElement}function l(d,u){i.drawElements(n,u,r,d*o),e.update(u,n,1)}function c(d,u,p){p!==0&&(i.drawElementsInstanced(n,u,r,d*o,p),e.update(u,n,p))}function h(d,u,p){if(p===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,u,0,r,d,0,p);let x=0;for(let g=0;g<p;g++)x+=u[g];e.update(x,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function kT(i){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(e.calls++,o){case i.TRIANGLES:e.triangles+=a*(r/3);break;case i.LINES:e.lines+=a*(r/2);break;case i.LINE_STRIP:e.lines+=a*(r-1);break;case i.LINE_LOOP:e.lines+=a*r;break;case i.POINTS:e.points+=a*r;break;default:te("WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:n}}function BT(i,t,e){let n=new WeakMap,s=new Qe;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,d=h!==void 0?h.length:0,u=n.get(a);if(u===void 0||u.count!==d){let F=function(){v.dispose(),n.delete(a),a.removeEventListener("dispose",F)};u!==void 0&&u.texture.dispose();let p=a.morphAttributes.position!==void 0,m=a.morphAttributes.normal!==void 0,x=a.morphAttributes.color!==void 0,g=a.morphAttributes.position||[],_=a.morphAttributes.normal||[],b=a.morphAttributes.color||[],S=0;p===!0&&(S=1),m===!0&&(S=2),x===!0&&(S=3);let y=a.attributes.position.count*S,C=1;y>t.maxTextureSize&&(C=Math.ceil(y/t.maxTextureSize),y=t.maxTextureSize);let E=new Float32Array(y*C*4*d),v=new Sa(E,y,C,d);v.type=Jn,v.needsUpdate=!0;let T=S*4;for(let L=0;L<d;L++){let D=g[L],B=_[L],G=b[L],N=y*C*4*L;for(let W=0;W<D.count;W++){let q=W*T;p===!0&&(s.fromBufferAttribute(D,W),E[N+q+0]=s.x,E[N+q+1]=s.y,E[N+q+2]=s.z,E[N+q+3]=0),m===!0&&(s.fromBufferAttribute(B,W),E[N+q+4]=s.x,E[N+q+5]=s.y,E[N+q+6]=s.z,E[N+q+7]=0),x===!0&&(s.fromBufferAttribute(G,W),E[N+q+8]=s.x,E[N+q+9]=s.y,E[N+q+10]=s.z,E[N+q+11]=G.itemSize===4?s.w:1)}}u={count:d,texture:v,size:new Vt(y,C)},n.set(a,u),a.addEventListener("dispose",F)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,e);else{let p=0;for(let x=0;x<c.length;x++)p+=c[x];let m=a.morphTargetsRelative?1:1-p;l.getUniforms().setValue(i,"morphTargetBaseInfluence",m),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",u.texture,e),l.getUniforms().setValue(i,"morphTargetsTextureSize",u.size)}return{update:r}}function zT(i,t,e,n,s){let r=new WeakMap;function o(c){let h=s.render.frame,d=c.geometry,u=t.get(c,d);if(r.get(u)!==h&&(t.update(u),r.set(u,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(e.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&e.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){let p=c.skeleton;r.get(p)!==h&&(p.update(),r.set(p,h))}return u}function a(){r=new WeakMap}function l(c){let h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),e.remove(h.instanceMatrix),h.instanceColor!==null&&e.remove(h.instanceColor)}return{update:o,dispose:a}}var HT={[_f]:"LINEAR_TONE_MAPPING",[yf]:"REINHARD_TONE_MAPPING",[vf]:"CINEON_TONE_MAPPING",[xf]:"ACES_FILMIC_TONE_MAPPING",[wf]:"AGX_TONE_MAPPING",[Sf]:"NEUTRAL_TONE_MAPPING",[bf]:"CUSTOM_TONE_MAPPING"};function GT(i,t,e,n,s,r){let o=new xi(t,e,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,h=new Fe;h.setAttribute("position",new Ee([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new Ee([0,2,0,0,2,0],2));let d=new Xc({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),u=new Ie(h,d),p=new Ga(-1,1,1,-1,0,1),m=null,x=null,g=!1,_,b=null,S=[],y=!1;this.setSize=function(C,E){o.setSize(C,E),a!==null&&a.setSize(C,E),l!==null&&l.setSize(C,E);for(let v=0;v<S.length;v++){let T=S[v];T.setSize&&T.setSize(C,E)}},this.setEffects=function(C){S=C,y=S.length>0&&S[0].isRenderPass===!0;let E=o.width,v=o.height;S.length>0&&a===null&&(a=new xi(E,v,{type:Vi,depthBuffer:!1,stencilBuffer:!1}),l=new xi(E,v,{type:Vi,depthBuffer:!1,stencilBuffer:!1}));let T=s===!0&&S.some(F=>F.needsDepthTexture===!0);T!==(o.depthTexture!==null)&&(T===!0&&c===null&&(c=new Ms(E,v),r===!0&&(c.format=As,c.type=Nr)),o.dispose(),o.depthTexture=T?c:null,o.resolveDepthBuffer=T,o.storeMultisampledDepthBuffer=T);for(let F=0;F<S.length;F++){let L=S[F];L.setSize&&L.setSize(E,v),T&&L.needsDepthTexture===!0&&L.setDepthTexture&&L.setDepthTexture(c)}},this.begin=function(C,E){if(g||C.toneMapping===es&&S.length===0)return!1;if(b=E,E!==null){let v=E.width,T=E.height;(o.width!==v||o.height!==T)&&this.setSize(v,T)}return y===!1&&C.setRenderTarget(o),_=C.toneMapping,C.toneMapping=es,!0},this.hasRenderPass=function(){return y},this.end=function(C,E){C.toneMapping=_,g=!0;let v=o,T=a;for(let F=0;F<S.length;F++){let L=S[F];L.enabled!==!1&&(L.render(C,T,v,E),L.needsSwap!==!1&&(v=T,T=T===a?l:a))}if(m!==C.outputColorSpace||x!==C.toneMapping){m=C.outputColorSpace,x=C.toneMapping,d.defines={},xe.getTransfer(m)===Pe&&(d.defines.SRGB_TRANSFER="");let F=HT[x];F&&(d.defines[F]=""),d.needsUpdate=!0}d.uniforms.tDiffuse.value=v.texture,C.setRenderTarget(b),C.render(u,p),b=null,g=!1},this.isCompositing=function(){return g},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),h.dispose(),d.dispose()}}var gy=new Zn,_y=new Ms(1,1),yy=new Ia(1),vy=new Sa,xy=new zc,by=new Pa,Z_=[],K_=[],J_=new Float32Array(16),j_=new Float32Array(9),Q_=new Float32Array(4);function Xo(i,t,e){let n=i[0];if(n<=0||n>0)return i;let s=t*e,r=Z_[s];if(r===void 0&&(r=new Float32Array(s),Z_[s]=r),t!==0){n.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,i[o].toArray(r,a)}return r}function Pn(i,t){if(i.length!==t.length)return!1;for(let e=0,n=i.length;e<n;e++)if(i[e]!==t[e])return!1;return!0}function In(i,t){for(let e=0,n=t.length;e<n;e++)i[e]=t[e]}function Kh(i,t){let e=K_[t];e===void 0&&(e=new Int32Array(t),K_[t]=e);for(let n=0;n!==t;++n)e[n]=i.allocateTextureUnit();return e}function VT(i,t){let e=this.cache;e[0]!==t&&(i.uniform1f(this.addr,t),e[0]=t)}function WT(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Pn(e,t))return;i.uniform2fv(this.addr,t),In(e,t)}}function $T(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(i.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(Pn(e,t))return;i.uniform3fv(this.addr,t),In(e,t)}}function XT(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Pn(e,t))return;i.uniform4fv(this.addr,t),In(e,t)}}function qT(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Pn(e,t))return;i.uniformMatrix2fv(this.addr,!1,t),In(e,t)}else{if(Pn(e,n))return;Q_.set(n),i.uniformMatrix2fv(this.addr,!1,Q_),In(e,n)}}function YT(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Pn(e,t))return;i.uniformMatrix3fv(this.addr,!1,t),In(e,t)}else{if(Pn(e,n))return;j_.set(n),i.uniformMatrix3fv(this.addr,!1,j_),In(e,n)}}function ZT(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Pn(e,t))return;i.uniformMatrix4fv(this.addr,!1,t),In(e,t)}else{if(Pn(e,n))return;J_.set(n),i.uniformMatrix4fv(this.addr,!1,J_),In(e,n)}}function KT(i,t){let e=this.cache;e[0]!==t&&(i.uniform1i(this.addr,t),e[0]=t)}function JT(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Pn(e,t))return;i.uniform2iv(this.addr,t),In(e,t)}}function jT(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Pn(e,t))return;i.uniform3iv(this.addr,t),In(e,t)}}function QT(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Pn(e,t))return;i.uniform4iv(this.addr,t),In(e,t)}}function t1(i,t){let e=this.cache;e[0]!==t&&(i.uniform1ui(this.addr,t),e[0]=t)}function e1(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Pn(e,t))return;i.uniform2uiv(this.addr,t),In(e,t)}}function n1(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Pn(e,t))return;i.uniform3uiv(this.addr,t),In(e,t)}}function i1(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Pn(e,t))return;i.uniform4uiv(this.addr,t),In(e,t)}}function Jh(i){return i.version===0&&(i.compareFunction=Nf,i.needsUpdate=!0),i}function s1(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=Jh(_y):r=gy,e.setTexture2D(t||r,s)}function r1(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture3D(t||xy,s)}function o1(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=Jh(yy):r=by,e.setTextureCube(t||r,s)}function a1(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture2DArray(t||vy,s)}function l1(i){switch(i){case 5126:return VT;case 35664:return WT;case 35665:return $T;case 35666:return XT;case 35674:return qT;case 35675:return YT;case 35676:return ZT;case 5124:case 35670:return KT;case 35667:case 35671:return JT;case 35668:case 35672:return jT;case 35669:case 35673:return QT;case 5125:return t1;case 36294:return e1;case 36295:return n1;case 36296:return i1;case 35678:case 36198:case 36298:case 36306:case 35682:return s1;case 35679:case 36299:case 36307:return r1;case 35680:case 36300:case 36308:case 36293:return o1;case 36289:case 36303:case 36311:case 36292:return a1}}function c1(i,t){i.uniform1fv(this.addr,t)}function h1(i,t){let e=Xo(t,this.size,2);i.uniform2fv(this.addr,e)}function u1(i,t){let e=Xo(t,this.size,3);i.uniform3fv(this.addr,e)}function d1(i,t){let e=Xo(t,this.size,4);i.uniform4fv(this.addr,e)}function f1(i,t){let e=Xo(t,this.size,4);i.uniformMatrix2fv(this.addr,!1,e)}function p1(i,t){let e=Xo(t,this.size,9);i.uniformMatrix3fv(this.addr,!1,e)}function m1(i,t){let e=Xo(t,this.size,16);i.uniformMatrix4fv(this.addr,!1,e)}function g1(i,t){i.uniform1iv(this.addr,t)}function _1(i,t){i.uniform2iv(this.addr,t)}function y1(i,t){i.uniform3iv(this.addr,t)}function v1(i,t){i.uniform4iv(this.addr,t)}function x1(i,t){i.uniform1uiv(this.addr,t)}function b1(i,t){i.uniform2uiv(this.addr,t)}function w1(i,t){i.uniform3uiv(this.addr,t)}function S1(i,t){i.uniform4uiv(this.addr,t)}function M1(i,t,e){let n=this.cache,s=t.length,r=Kh(e,s);Pn(n,r)||(i.uniform1iv(this.addr,r),In(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=Jh(_y):o=gy;for(let a=0;a!==s;++a)e.setTexture2D(t[a]||o,r[a])}function E1(i,t,e){let n=this.cache,s=t.length,r=Kh(e,s);Pn(n,r)||(i.uniform1iv(this.addr,r),In(n,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||xy,r[o])}function T1(i,t,e){let n=this.cache,s=t.length,r=Kh(e,s);Pn(n,r)||(i.uniform1iv(this.addr,r),In(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=Jh(yy):o=by;for(let a=0;a!==s;++a)e.setTextureCube(t[a]||o,r[a])}function A1(i,t,e){let n=this.cache,s=t.length,r=Kh(e,s);Pn(n,r)||(i.uniform1iv(this.addr,r),In(n,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||vy,r[o])}function R1(i){switch(i){case 5126:return c1;case 35664:return h1;case 35665:return u1;case 35666:return d1;case 35674:return f1;case 35675:return p1;case 35676:return m1;case 5124:case 35670:return g1;case 35667:case 35671:return _1;case 35668:case 35672:return y1;case 35669:case 35673:return v1;case 5125:return x1;case 36294:return b1;case 36295:return w1;case 36296:return S1;case 35678:case 36198:case 36298:case 36306:case 35682:return M1;case 35679:case 36299:case 36307:return E1;case 35680:case 36300:case 36308:case 36293:return T1;case 36289:case 36303:case 36311:case 36292:return A1}}var Xf=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.setValue=l1(e.type)}},qf=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=R1(e.type)}},Yf=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],n)}}},Wf=/(\w+)(\])?(\[|\.)?/g;function ty(i,t){i.seq.push(t),i.map[t.id]=t}function C1(i,t,e){let n=i.name,s=n.length;for(Wf.lastIndex=0;;){let r=Wf.exec(n),o=Wf.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){ty(e,c===void 0?new Xf(a,i,t):new qf(a,i,t));break}else{let d=e.map[a];d===void 0&&(d=new Yf(a),ty(e,d)),e=d}}}var $o=class{constructor(t,e){this.seq=[],this.map={};let n=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=t.getActiveUniform(e,o),l=t.getUniformLocation(e,a.name);C1(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===t.SAMPLER_2D_SHADOW||o.type===t.SAMPLER_CUBE_SHADOW||o.type===t.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(t,e,n,s){let r=this.map[e];r!==void 0&&r.setValue(t,n,s)}setOptional(t,e,n){let s=e[n];s!==void 0&&this.setValue(t,n,s)}static upload(t,e,n,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(t,l.value,s)}}static seqWithValue(t,e){let n=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&n.push(o)}return n}};function ey(i,t,e){let n=i.createShader(t);return i.shaderSource(n,e),i.compileShader(n),n}var P1=37297,I1=0;function L1(i,t){let e=i.split(`
`),n=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return n.join(`
`)}var ny=new ne;function D1(i){xe._getMatrix(ny,xe.workingColorSpace,i);let t=`mat3( ${ny.elements.map(e=>e.toFixed(4))} )`;switch(xe.getTransfer(i)){case ba:return[t,"LinearTransferOETF"];case Pe:return[t,"sRGBTransferOETF"];default:return Yt("WebGLProgram: Unsupported color space: ",i),[t,"LinearTransferOETF"]}}function iy(i,t,e){let n=i.getShaderParameter(t,i.COMPILE_STATUS),r=(i.getShaderInfoLog(t)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return e.toUpperCase()+`

`+r+`

`+L1(i.getShaderSource(t),a)}else return r}function N1(i,t){let e=D1(t);return[`vec4 ${i}( vec4 value ) {`,`	return ${e[1]}( vec4( ${e[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var U1={[_f]:"Linear",[yf]:"Reinhard",[vf]:"Cineon",[xf]:"ACESFilmic",[wf]:"AgX",[Sf]:"Neutral",[bf]:"Custom"};function F1(i,t){let e=U1[t];return e===void 0?(Yt("WebGLProgram: Unsupported toneMapping:",t),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var qh=new H;function O1(){xe.getLuminanceCoefficients(qh);let i=qh.x.toFixed(4),t=qh.y.toFixed(4),e=qh.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function k1(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(el).join(`
`)}function B1(i){let t=[];for(let e in i){let n=i[e];n!==!1&&t.push("#define "+e+" "+n)}return t.join(`
`)}function z1(i,t){let e={},n=i.getProgramParameter(t,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(t,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:i.getAttribLocation(t,o),locationSize:a}}return e}function el(i){return i!==""}function sy(i,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function ry(i,t){return i.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var H1=/^[ \t]*#include +<([\w\d./]+)>/gm;function Zf(i){return i.replace(H1,G1)}function G1(i,t){let e=ue[t];if(e===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+t+">");return Zf(e)}var V1=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function oy(i){return i.replace(V1,W1)}function W1(i,t,e,n){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function ay(i){let t=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?t+=`
#define HIGH_PRECISION`:i.precision==="mediump"?t+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(t+=`
#define LOW_PRECISION`),t}var $1={[Pr]:"SHADOWMAP_TYPE_PCF",[Bo]:"SHADOWMAP_TYPE_VSM"};function X1(i){return $1[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var q1={[Ho]:"ENVMAP_MODE_REFRACTION"};function Y1(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":q1[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var Z1={[oh]:"ENVMAP_BLENDING_MULTIPLY",[v_]:"ENVMAP_BLENDING_MIX",[x_]:"ENVMAP_BLENDING_ADD"};function K1(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":Z1[i.combine]||"ENVMAP_BLENDING_NONE"}function J1(i,t,e,n){let s=i.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,l=X1(e),c=e.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=Y1(e),d=K1(e),u=k1(e),p=B1(r),m=s.createProgram(),x,g,_=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(x=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,p].filter(el).join(`
`),x.length>0&&(x+=`
`),g=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,p].filter(el).join(`
`),g.length>0&&(g+=`
`)):(x=[ay(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,p,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+h:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+e.diffuseRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexNormals?"#define HAS_NORMAL":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(el).join(`
`),g=[ay(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,p,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+c:"",e.envMap?"#define "+h:"",e.envMap?"#define "+d:"",e.envMapPMREM?"#define ENVMAP_MAX_LOD "+e.envMapMaxLod+".0":"",e.envMapPMREM?"#define ENVMAP_SIZE "+e.envMapSize+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.retroreflection?"#define USE_RETROREFLECTION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor?"#define USE_COLOR":"",e.vertexAlphas||e.batchingColor?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==es?"#define TONE_MAPPING":"",e.toneMapping!==es?ue.tonemapping_pars_fragment:"",e.toneMapping!==es?F1("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",ue.colorspace_pars_fragment,N1("linearToOutputTexel",e.outputColorSpace),O1(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(el).join(`
`)),o=Zf(o),o=sy(o,e),o=ry(o,e),a=Zf(a),a=sy(a,e),a=ry(a,e),o=oy(o),a=oy(a),e.isRawShaderMaterial!==!0&&(_=`#version 300 es
`,x=[u,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+x,g=["#define varying in",e.glslVersion===Uf?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===Uf?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+g);let b=_+x+o,S=_+g+a,y=ey(s,s.VERTEX_SHADER,b),C=ey(s,s.FRAGMENT_SHADER,S);s.attachShader(m,y),s.attachShader(m,C),e.index0AttributeName!==void 0?s.bindAttribLocation(m,0,e.index0AttributeName):e.hasPositionAttribute===!0&&s.bindAttribLocation(m,0,"position"),s.linkProgram(m);function E(L){if(i.debug.checkShaderErrors){let D=s.getProgramInfoLog(m)||"",B=s.getShaderInfoLog(y)||"",G=s.getShaderInfoLog(C)||"",N=D.trim(),W=B.trim(),q=G.trim(),V=!0,lt=!0;if(s.getProgramParameter(m,s.LINK_STATUS)===!1)if(V=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,m,y,C);else{let Z=iy(s,y,"vertex"),j=iy(s,C,"fragment");te("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(m,s.VALIDATE_STATUS)+`

Material Name: `+L.name+`
Material Type: `+L.type+`

Program Info Log: `+N+`
`+Z+`
`+j)}else N!==""?Yt("WebGLProgram: Program Info Log:",N):(W===""||q==="")&&(lt=!1);lt&&(L.diagnostics={runnable:V,programLog:N,vertexShader:{log:W,prefix:x},fragmentShader:{log:q,prefix:g}})}s.deleteShader(y),s.deleteShader(C),v=new $o(s,m),T=z1(s,m)}let v;this.getUniforms=function(){return v===void 0&&E(this),v};let T;this.getAttributes=function(){return T===void 0&&E(this),T};let F=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return F===!1&&(F=s.getProgramParameter(m,P1)),F},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(m),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=I1++,this.cacheKey=t,this.usedTimes=1,this.program=m,this.vertexShader=y,this.fragmentShader=C,this}var j1=0,Kf=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t,e,n){let s=this._getShaderCacheForMaterial(t);return s.has(e)===!1&&(s.add(e),e.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let n of e)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(t),this}getVertexShaderStage(t){return this._getShaderStage(t.vertexShader)}getFragmentShaderStage(t){return this._getShaderStage(t.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,n=e.get(t);return n===void 0&&(n=new Set,e.set(t,n)),n}_getShaderStage(t){let e=this.shaderCache,n=e.get(t);return n===void 0&&(n=new Jf(t),e.set(t,n)),n}},Jf=class{constructor(t){this.id=j1++,this.code=t,this.usedTimes=0}};function Q1(i){return i===lr||i===Ja||i===ja}function tA(i,t,e,n,s,r){let o=new Lo,a=new Kf,l=new Set,c=[],h=new Map,d=n.logarithmicDepthBuffer,u={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function p(v){return l.add(v),v===0?"uv":`uv${v}`}function m(v,T,F,L,D,B){let G=L.fog,N=D.geometry,W=v.isMeshStandardMaterial||v.isMeshLambertMaterial||v.isMeshPhongMaterial?L.environment:null,q=v.isMeshStandardMaterial||v.isMeshLambertMaterial&&!v.envMap||v.isMeshPhongMaterial&&!v.envMap,V=t.get(v.envMap||W,q),lt=u[v.type],Z=n.precision;v.precision!==null&&(Z=n.getMaxPrecision(v.precision),Z!==v.precision&&Yt("WebGLProgram.getParameters:",v.precision,"not supported, using",Z,"instead."));let j=N.morphAttributes.position||N.morphAttributes.normal||N.morphAttributes.color,et=j!==void 0?j.length:0,dt=0;N.morphAttributes.position!==void 0&&(dt=1),N.morphAttributes.normal!==void 0&&(dt=2),N.morphAttributes.color!==void 0&&(dt=3);let ut,tt,gt,vt;if(lt){let Ct=is[lt];ut=Ct.vertexShader,tt=Ct.fragmentShader}else{ut=v.vertexShader,tt=v.fragmentShader;let Ct=a.getVertexShaderStage(v),ae=a.getFragmentShaderStage(v);a.update(v,Ct,ae),gt=Ct.id,vt=ae.id}let Rt=i.getRenderTarget(),St=i.state.buffers.depth.getReversed(),$t=D.isInstancedMesh===!0,re=D.isBatchedMesh===!0,Gt=!!v.map,de=!!v.matcap,le=!!V,ie=le&&V.isPMREMTexture===!0,Je=!!v.aoMap,We=!!v.lightMap,mn=!!v.bumpMap&&v.wireframe===!1,Oe=!!v.normalMap,Dn=!!v.displacementMap,be=!!v.emissiveMap,Mn=!!v.metalnessMap,on=!!v.roughnessMap,gn=v.anisotropy>0,k=v.clearcoat>0,Pt=v.diffuseRoughness>0,Kt=v.dispersion>0,oe=v.retroreflectivity>0,Mt=v.iridescence>0,Be=v.sheen>0,Ht=v.transmission>0,qt=gn&&!!v.anisotropyMap,P=k&&!!v.clearcoatMap,M=k&&!!v.clearcoatNormalMap,X=k&&!!v.clearcoatRoughnessMap,ht=Pt&&!!v.diffuseRoughnessMap,ot=Mt&&!!v.iridescenceMap,yt=Mt&&!!v.iridescenceThicknessMap,xt=Be&&!!v.sheenColorMap,nt=Be&&!!v.sheenRoughnessMap,st=!!v.specularMap,mt=!!v.specularColorMap,O=!!v.specularIntensityMap,rt=Ht&&!!v.transmissionMap,it=Ht&&!!v.thicknessMap,Et=!!v.gradientMap,_t=!!v.alphaMap,wt=v.alphaTest>0,Wt=!!v.alphaHash,jt=!!v.extensions,ct=es;v.toneMapped&&(Rt===null||Rt.isXRRenderTarget===!0)&&(ct=i.toneMapping);let kt=ie?V.isCompressedCubeTexture?V.image[0].mipmaps:V.mipmaps:null,Qt={shaderID:lt,shaderType:v.type,shaderName:v.name,vertexShader:ut,fragmentShader:tt,defines:v.defines,customVertexShaderID:gt,customFragmentShaderID:vt,isRawShaderMaterial:v.isRawShaderMaterial===!0,glslVersion:v.glslVersion,precision:Z,batching:re,batchingColor:re&&D._colorsTexture!==null,instancing:$t,instancingColor:$t&&D.instanceColor!==null,instancingMorph:$t&&D.morphTexture!==null,outputColorSpace:Rt===null?i.outputColorSpace:Rt.isXRRenderTarget===!0?Rt.texture.colorSpace:xe.workingColorSpace,alphaToCoverage:!!v.alphaToCoverage,map:Gt,matcap:de,envMap:le,envMapMode:le&&V.mapping,envMapPMREM:ie,envMapMaxLod:ie?kt.length-1:null,envMapSize:ie?kt[0].width:null,aoMap:Je,lightMap:We,bumpMap:mn,normalMap:Oe,displacementMap:Dn,emissiveMap:be,normalMapObjectSpace:Oe&&v.normalMapType===S_,normalMapTangentSpace:Oe&&v.normalMapType===Qa,packedNormalMap:Oe&&v.normalMapType===Qa&&Q1(v.normalMap.format),metalnessMap:Mn,roughnessMap:on,anisotropy:gn,anisotropyMap:qt,clearcoat:k,clearcoatMap:P,clearcoatNormalMap:M,clearcoatRoughnessMap:X,diffuseRoughness:Pt,diffuseRoughnessMap:ht,dispersion:Kt,retroreflection:oe,iridescence:Mt,iridescenceMap:ot,iridescenceThicknessMap:yt,sheen:Be,sheenColorMap:xt,sheenRoughnessMap:nt,specularMap:st,specularColorMap:mt,specularIntensityMap:O,transmission:Ht,transmissionMap:rt,thicknessMap:it,gradientMap:Et,opaque:v.transparent===!1&&v.blending===zo&&v.alphaToCoverage===!1,alphaMap:_t,alphaTest:wt,alphaHash:Wt,combine:v.combine,mapUv:Gt&&p(v.map.channel),aoMapUv:Je&&p(v.aoMap.channel),lightMapUv:We&&p(v.lightMap.channel),bumpMapUv:mn&&p(v.bumpMap.channel),normalMapUv:Oe&&p(v.normalMap.channel),displacementMapUv:Dn&&p(v.displacementMap.channel),emissiveMapUv:be&&p(v.emissiveMap.channel),metalnessMapUv:Mn&&p(v.metalnessMap.channel),roughnessMapUv:on&&p(v.roughnessMap.channel),anisotropyMapUv:qt&&p(v.anisotropyMap.channel),clearcoatMapUv:P&&p(v.clearcoatMap.channel),clearcoatNormalMapUv:M&&p(v.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:X&&p(v.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:ht&&p(v.diffuseRoughnessMap.channel),iridescenceMapUv:ot&&p(v.iridescenceMap.channel),iridescenceThicknessMapUv:yt&&p(v.iridescenceThicknessMap.channel),sheenColorMapUv:xt&&p(v.sheenColorMap.channel),sheenRoughnessMapUv:nt&&p(v.sheenRoughnessMap.channel),specularMapUv:st&&p(v.specularMap.channel),specularColorMapUv:mt&&p(v.specularColorMap.channel),specularIntensityMapUv:O&&p(v.specularIntensityMap.channel),transmissionMapUv:rt&&p(v.transmissionMap.channel),thicknessMapUv:it&&p(v.thicknessMap.channel),alphaMapUv:_t&&p(v.alphaMap.channel),vertexTangents:!!N.attributes.tangent&&(Oe||gn),vertexNormals:!!N.attributes.normal,vertexColors:v.vertexColors,vertexAlphas:v.vertexColors===!0&&!!N.attributes.color&&N.attributes.color.itemSize===4,pointsUvs:D.isPoints===!0&&!!N.attributes.uv&&(Gt||_t),fog:!!G,useFog:v.fog===!0,fogExp2:!!G&&G.isFogExp2,flatShading:v.wireframe===!1&&(v.flatShading===!0||N.attributes.normal===void 0&&Oe===!1&&(v.isMeshLambertMaterial||v.isMeshPhongMaterial||v.isMeshStandardMaterial||v.isMeshPhysicalMaterial)),sizeAttenuation:v.sizeAttenuation===!0,logarithmicDepthBuffer:d,reversedDepthBuffer:St,skinning:D.isSkinnedMesh===!0,hasPositionAttribute:N.attributes.position!==void 0,morphTargets:N.morphAttributes.position!==void 0,morphNormals:N.morphAttributes.normal!==void 0,morphColors:N.morphAttributes.color!==void 0,morphTargetsCount:et,morphTextureStride:dt,numSunLights:T.sun.length,numDirLights:T.directional.length,numPointLights:T.point.length,numSpotLights:T.spot.length,numSpotLightMaps:T.spotLightMap.length,numRectAreaLights:T.rectArea.length,numHemiLights:T.hemi.length,numSunLightShadows:T.sunShadowMap.length,numDirLightShadows:T.directionalShadowMap.length,numPointLightShadows:T.pointShadowMap.length,numSpotLightShadows:T.spotShadowMap.length,numSpotLightShadowsWithMaps:T.numSpotLightShadowsWithMaps,numLightProbes:T.numLightProbes,numLightProbeGrids:B.filter(Ct=>Ct.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:v.dithering,shadowMapEnabled:i.shadowMap.enabled&&F.length>0,shadowMapType:i.shadowMap.type,toneMapping:ct,decodeVideoTexture:Gt&&v.map.isVideoTexture===!0&&xe.getTransfer(v.map.colorSpace)===Pe,decodeVideoTextureEmissive:be&&v.emissiveMap.isVideoTexture===!0&&xe.getTransfer(v.emissiveMap.colorSpace)===Pe,premultipliedAlpha:v.premultipliedAlpha,doubleSided:v.side===$n,flipSided:v.side===li,useDepthPacking:v.depthPacking>=0,depthPacking:v.depthPacking||0,index0AttributeName:v.index0AttributeName,extensionClipCullDistance:jt&&v.extensions.clipCullDistance===!0&&e.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(jt&&v.extensions.multiDraw===!0||re)&&e.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:e.has("KHR_parallel_shader_compile"),customProgramCacheKey:v.customProgramCacheKey()};return Qt.vertexUv1s=l.has(1),Qt.vertexUv2s=l.has(2),Qt.vertexUv3s=l.has(3),l.clear(),Qt}function x(v){let T=[];if(v.shaderID?T.push(v.shaderID):(T.push(v.customVertexShaderID),T.push(v.customFragmentShaderID)),v.defines!==void 0)for(let F in v.defines)T.push(F),T.push(v.defines[F]);return v.isRawShaderMaterial===!1&&(g(T,v),_(T,v),T.push(i.outputColorSpace)),T.push(v.customProgramCacheKey),T.join()}function g(v,T){v.push(T.precision),v.push(T.outputColorSpace),v.push(T.envMapMode),v.push(T.envMapPMREM),v.push(T.envMapMaxLod),v.push(T.envMapSize),v.push(T.mapUv),v.push(T.alphaMapUv),v.push(T.lightMapUv),v.push(T.aoMapUv),v.push(T.bumpMapUv),v.push(T.normalMapUv),v.push(T.displacementMapUv),v.push(T.emissiveMapUv),v.push(T.metalnessMapUv),v.push(T.roughnessMapUv),v.push(T.anisotropyMapUv),v.push(T.clearcoatMapUv),v.push(T.clearcoatNormalMapUv),v.push(T.clearcoatRoughnessMapUv),v.push(T.diffuseRoughnessMapUv),v.push(T.iridescenceMapUv),v.push(T.iridescenceThicknessMapUv),v.push(T.sheenColorMapUv),v.push(T.sheenRoughnessMapUv),v.push(T.specularMapUv),v.push(T.specularColorMapUv),v.push(T.specularIntensityMapUv),v.push(T.transmissionMapUv),v.push(T.thicknessMapUv),v.push(T.combine),v.push(T.fogExp2),v.push(T.sizeAttenuation),v.push(T.morphTargetsCount),v.push(T.numSunLights),v.push(T.numDirLights),v.push(T.numPointLights),v.push(T.numSpotLights),v.push(T.numSpotLightMaps),v.push(T.numHemiLights),v.push(T.numRectAreaLights),v.push(T.numSunLightShadows),v.push(T.numDirLightShadows),v.push(T.numPointLightShadows),v.push(T.numSpotLightShadows),v.push(T.numSpotLightShadowsWithMaps),v.push(T.numLightProbes),v.push(T.numLightProbeGrids),v.push(T.shadowMapType),v.push(T.toneMapping),v.push(T.numClippingPlanes),v.push(T.numClipIntersection),v.push(T.depthPacking)}function _(v,T){o.disableAll(),T.instancing&&o.enable(0),T.instancingColor&&o.enable(1),T.instancingMorph&&o.enable(2),T.matcap&&o.enable(3),T.envMap&&o.enable(4),T.normalMapObjectSpace&&o.enable(5),T.normalMapTangentSpace&&o.enable(6),T.clearcoat&&o.enable(7),T.iridescence&&o.enable(8),T.alphaTest&&o.enable(9),T.vertexColors&&o.enable(10),T.vertexAlphas&&o.enable(11),T.vertexUv1s&&o.enable(12),T.vertexUv2s&&o.enable(13),T.vertexUv3s&&o.enable(14),T.vertexTangents&&o.enable(15),T.anisotropy&&o.enable(16),T.alphaHash&&o.enable(17),T.batching&&o.enable(18),T.dispersion&&o.enable(19),T.retroreflection&&o.enable(24),T.diffuseRoughness&&o.enable(25),T.batchingColor&&o.enable(20),T.gradientMap&&o.enable(21),T.packedNormalMap&&o.enable(22),T.vertexNormals&&o.enable(23),v.push(o.mask),o.disableAll(),T.fog&&o.enable(0),T.useFog&&o.enable(1),T.flatShading&&o.enable(2),T.logarithmicDepthBuffer&&o.enable(3),T.reversedDepthBuffer&&o.enable(4),T.skinning&&o.enable(5),T.morphTargets&&o.enable(6),T.morphNormals&&o.enable(7),T.morphColors&&o.enable(8),T.premultipliedAlpha&&o.enable(9),T.shadowMapEnabled&&o.enable(10),T.doubleSided&&o.enable(11),T.flipSided&&o.enable(12),T.useDepthPacking&&o.enable(13),T.dithering&&o.enable(14),T.transmission&&o.enable(15),T.sheen&&o.enable(16),T.opaque&&o.enable(17),T.pointsUvs&&o.enable(18),T.decodeVideoTexture&&o.enable(19),T.decodeVideoTextureEmissive&&o.enable(20),T.alphaToCoverage&&o.enable(21),T.numLightProbeGrids>0&&o.enable(22),T.hasPositionAttribute&&o.enable(23),v.push(o.mask)}function b(v){let T=u[v.type],F;if(T){let L=is[T];F=G_.clone(L.uniforms)}else F=v.uniforms;return F}function S(v,T){let F=h.get(T);return F!==void 0?++F.usedTimes:(F=new J1(i,T,v,s),c.push(F),h.set(T,F)),F}function y(v){if(--v.usedTimes===0){let T=c.indexOf(v);c[T]=c[c.length-1],c.pop(),h.delete(v.cacheKey),v.destroy()}}function C(v){a.remove(v)}function E(){a.dispose()}return{getParameters:m,getProgramCacheKey:x,getUniforms:b,acquireProgram:S,releaseProgram:y,releaseShaderCache:C,programs:c,dispose:E}}function eA(){let i=new WeakMap;function t(o){return i.has(o)}function e(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:t,get:e,remove:n,update:s,dispose:r}}function nA(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.material.id!==t.material.id?i.material.id-t.material.id:i.materialVariant!==t.materialVariant?i.materialVariant-t.materialVariant:i.z!==t.z?i.z-t.z:i.id-t.id}function ly(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.z!==t.z?t.z-i.z:i.id-t.id}function cy(){let i=[],t=0,e=[],n=[],s=[];function r(){t=0,e.length=0,n.length=0,s.length=0}function o(u){let p=0;return u.isInstancedMesh&&(p+=2),u.isSkinnedMesh&&(p+=1),p}function a(u,p,m,x,g,_){let b=i[t];return b===void 0?(b={id:u.id,object:u,geometry:p,material:m,materialVariant:o(u),groupOrder:x,renderOrder:u.renderOrder,z:g,group:_},i[t]=b):(b.id=u.id,b.object=u,b.geometry=p,b.material=m,b.materialVariant=o(u),b.groupOrder=x,b.renderOrder=u.renderOrder,b.z=g,b.group=_),t++,b}function l(u,p,m,x,g,_,b){b.reversedDepth===!0&&(g=-g);let S=a(u,p,m,x,g,_);m.transmission>0?n.push(S):m.transparent===!0?s.push(S):e.push(S)}function c(u,p,m,x,g,_){let b=a(u,p,m,x,g,_);m.transmission>0?n.unshift(b):m.transparent===!0?s.unshift(b):e.unshift(b)}function h(u,p){e.length>1&&e.sort(u||nA),n.length>1&&n.sort(p||ly),s.length>1&&s.sort(p||ly)}function d(){for(let u=t,p=i.length;u<p;u++){let m=i[u];if(m.id===null)break;m.id=null,m.object=null,m.geometry=null,m.material=null,m.group=null}}return{opaque:e,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:d,sort:h}}function iA(){let i=new WeakMap;function t(n,s){let r=i.get(n),o;return r===void 0?(o=new cy,i.set(n,[o])):s>=r.length?(o=new cy,r.push(o)):o=r[s],o}function e(){i=new WeakMap}return{get:t,dispose:e}}function sA(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={direction:new H,color:new Zt};break;case"SpotLight":e={position:new H,direction:new H,color:new Zt,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new H,color:new Zt,distance:0,decay:0};break;case"HemisphereLight":e={direction:new H,skyColor:new Zt,groundColor:new Zt};break;case"RectAreaLight":e={color:new Zt,position:new H,halfWidth:new H,halfHeight:new H};break}return i[t.id]=e,e}}}function rA(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[t.id]=e,e}}}var oA=0;function aA(i,t){return(t.castShadow?2:0)-(i.castShadow?2:0)+(t.map?1:0)-(i.map?1:0)}function lA(i){let t=new sA,e=rA(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new H);let s=new H,r=new Ve,o=new Ve;function a(c){let h=0,d=0,u=0;for(let B=0;B<9;B++)n.probe[B].set(0,0,0);let p=0,m=0,x=0,g=0,_=0,b=0,S=0,y=0,C=0,E=0,v=0,T=0,F=0,L=0;c.sort(aA);for(let B=0,G=c.length;B<G;B++){let N=c[B],W=N.color,q=N.intensity,V=N.distance,lt=null;if(N.shadow&&N.shadow.map&&(N.shadow.map.texture.format===lr?lt=N.shadow.map.texture:lt=N.shadow.map.depthTexture||N.shadow.map.texture),N.isAmbientLight)h+=W.r*q,d+=W.g*q,u+=W.b*q;else if(N.isLightProbe){for(let Z=0;Z<9;Z++)n.probe[Z].addScaledVector(N.sh.coefficients[Z],q);L++}else if(N.isSunLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize.copy(j.mapSize).multiply(j.getFrameExtents()),n.sunShadow[m]=et,n.sunShadowMap[m]=lt;let dt=j.getViewportCount();for(let ut=0;ut<dt;ut++)n.sunShadowMatrix[x+ut]=j.getMatrix(ut),n.sunShadowCascade[x+ut]=j._cascadeData[ut];x+=dt,m++}n.sun[p]=Z,p++}else if(N.isDirectionalLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,n.directionalShadow[g]=et,n.directionalShadowMap[g]=lt,n.directionalShadowMatrix[g]=N.shadow.matrix,C++}n.directional[g]=Z,g++}else if(N.isSpotLight){let Z=t.get(N);Z.position.setFromMatrixPosition(N.matrixWorld),Z.color.copy(W).multiplyScalar(q),Z.distance=V,Z.coneCos=Math.cos(N.angle),Z.penumbraCos=Math.cos(N.angle*(1-N.penumbra)),Z.decay=N.decay,n.spot[b]=Z;let j=N.shadow;if(N.map&&(n.spotLightMap[T]=N.map,T++,j.updateMatrices(N),N.castShadow&&F++),n.spotLightMatrix[b]=j.matrix,N.castShadow){let et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,n.spotShadow[b]=et,n.spotShadowMap[b]=lt,v++}b++}else if(N.isRectAreaLight){let Z=t.get(N);Z.color.copy(W).multiplyScalar(q),Z.halfWidth.set(N.width*.5,0,0),Z.halfHeight.set(0,N.height*.5,0),n.rectArea[S]=Z,S++}else if(N.isPointLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),Z.distance=N.distance,Z.decay=N.decay,N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,et.shadowCameraNear=j.camera.near,et.shadowCameraFar=j.camera.far,n.pointShadow[_]=et,n.pointShadowMap[_]=lt,n.pointShadowMatrix[_]=N.shadow.matrix,E++}n.point[_]=Z,_++}else if(N.isHemisphereLight){let Z=t.get(N);Z.skyColor.copy(N.color).multiplyScalar(q),Z.groundColor.copy(N.groundColor).multiplyScalar(q),n.hemi[y]=Z,y++}}S>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=Dt.LTC_FLOAT_1,n.rectAreaLTC2=Dt.LTC_FLOAT_2):(n.rectAreaLTC1=Dt.LTC_HALF_1,n.rectAreaLTC2=Dt.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=d,n.ambient[2]=u;let D=n.hash;(D.sunLength!==p||D.directionalLength!==g||D.pointLength!==_||D.spotLength!==b||D.rectAreaLength!==S||D.hemiLength!==y||D.numSunShadows!==m||D.numDirectionalShadows!==C||D.numPointShadows!==E||D.numSpotShadows!==v||D.numSpotMaps!==T||D.numLightProbes!==L)&&(n.sun.length=p,n.directional.length=g,n.spot.length=b,n.rectArea.length=S,n.point.length=_,n.hemi.length=y,n.sunShadow.length=m,n.sunShadowMap.length=m,n.sunShadowMatrix.length=x,n.sunShadowCascade.length=x,n.directionalShadow.length=C,n.directionalShadowMap.length=C,n.directionalShadowMatrix.length=C,n.pointShadow.length=E,n.pointShadowMap.length=E,n.pointShadowMatrix.length=E,n.spotShadow.length=v,n.spotShadowMap.length=v,n.spotLightMatrix.length=v+T-F,n.spotLightMap.length=T,n.numSpotLightShadowsWithMaps=F,n.numLightProbes=L,D.sunLength=p,D.directionalLength=g,D.pointLength=_,D.spotLength=b,D.rectAreaLength=S,D.hemiLength=y,D.numSunShadows=m,D.numDirectionalShadows=C,D.numPointShadows=E,D.numSpotShadows=v,D.numSpotMaps=T,D.numLightProbes=L,n.version=oA++)}function l(c,h){let d=0,u=0,p=0,m=0,x=0,g=0,_=h.matrixWorldInverse;for(let b=0,S=c.length;b<S;b++){let y=c[b];if(y.isSunLight){let C=n.sun[d];C.direction.setFromMatrixPosition(y.matrixWorld),C.direction.transformDirection(_),d++}else if(y.isDirectionalLight){let C=n.directional[u];C.direction.setFromMatrixPosition(y.matrixWorld),s.setFromMatrixPosition(y.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(_),u++}else if(y.isSpotLight){let C=n.spot[m];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(_),C.direction.setFromMatrixPosition(y.matrixWorld),s.setFromMatrixPosition(y.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(_),m++}else if(y.isRectAreaLight){let C=n.rectArea[x];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(_),o.identity(),r.copy(y.matrixWorld),r.premultiply(_),o.extractRotation(r),C.halfWidth.set(y.width*.5,0,0),C.halfHeight.set(0,y.height*.5,0),C.halfWidth.applyMatrix4(o),C.halfHeight.applyMatrix4(o),x++}else if(y.isPointLight){let C=n.point[p];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(_),p++}else if(y.isHemisphereLight){let C=n.hemi[g];C.direction.setFromMatrixPosition(y.matrixWorld),C.direction.transformDirection(_),g++}}}return{setup:a,setupView:l,state:n}}function hy(i){let t=new lA(i),e=[],n=[],s=[];function r(d){h.camera=d,e.length=0,n.length=0,s.length=0}function o(d){d.isLightProbeGrid?s.push(d):e.push(d)}function a(d){n.push(d)}function l(){t.setup(e),s.sort((d,u)=>d.priority-u.priority||d.id-u.id)}function c(d){t.setupView(e,d)}let h={lightsArray:e,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function cA(i){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new hy(i),t.set(s,[a])):r>=o.length?(a=new hy(i),o.push(a)):a=o[r],a}function n(){t=new WeakMap}return{get:e,dispose:n}}var hA=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,uA=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,dA=[new H(1,0,0),new H(-1,0,0),new H(0,1,0),new H(0,-1,0),new H(0,0,1),new H(0,0,-1)],fA=[new H(0,-1,0),new H(0,-1,0),new H(0,0,1),new H(0,0,-1),new H(0,-1,0),new H(0,-1,0)],uy=new Ve,tl=new H,$f=new H;function pA(i,t,e){let n=new Zs,s=new Vt,r=new Vt,o=new Qe,a=new js,l=new qc,c={},h=e.maxTextureSize,d={[ar]:li,[li]:ar,[$n]:$n},u=new Ci({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new Vt},radius:{value:4}},vertexShader:hA,fragmentShader:uA}),p=u.clone();p.defines.HORIZONTAL_PASS=1;let m=new Fe;m.setAttribute("position",new Ue(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let x=new Ie(m,u),g=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=Pr;let _=this.type;this.render=function(E,v,T){if(g.enabled===!1||g.autoUpdate===!1&&g.needsUpdate===!1||E.length===0)return;this.type===t_&&(Yt("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=Pr);let F=i.getRenderTarget(),L=i.getActiveCubeFace(),D=i.getActiveMipmapLevel(),B=i.state;B.setBlending(Ir),B.buffers.depth.getReversed()===!0?B.buffers.color.setClear(0,0,0,0):B.buffers.color.setClear(1,1,1,1),B.buffers.depth.setTest(!0),B.setScissorTest(!1);let G=_!==this.type;G&&v.traverse(function(N){N.material&&(Array.isArray(N.material)?N.material.forEach(W=>W.needsUpdate=!0):N.material.needsUpdate=!0)});for(let N=0,W=E.length;N<W;N++){let q=E[N],V=q.shadow;if(V===void 0){Yt("WebGLShadowMap:",q,"has no shadow.");continue}if(V.autoUpdate===!1&&V.needsUpdate===!1)continue;s.copy(V.mapSize);let lt=V.getFrameExtents();s.multiply(lt),r.copy(V.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/lt.x),s.x=r.x*lt.x,V.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/lt.y),s.y=r.y*lt.y,V.mapSize.y=r.y));let Z=i.state.buffers.depth.getReversed();if(V.camera._reversedDepth=Z,V.map===null||G===!0){if(V.map!==null&&(V.map.depthTexture!==null&&(V.map.depthTexture.dispose(),V.map.depthTexture=null),V.map.dispose()),this.type===Bo){if(q.isPointLight){Yt("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}V.map=new xi(s.x,s.y,{format:lr,type:Vi,minFilter:Vn,magFilter:Vn,generateMipmaps:!1}),V.map.texture.name=q.name+".shadowMap",V.map.depthTexture=new Ms(s.x,s.y,Jn),V.map.depthTexture.name=q.name+".shadowMapDepth",V.map.depthTexture.format=bs,V.map.depthTexture.compareFunction=null,V.map.depthTexture.minFilter=Bn,V.map.depthTexture.magFilter=Bn}else q.isPointLight?(V.map=new nl(s.x),V.map.depthTexture=new Ia(s.x,Gi)):(V.map=new xi(s.x,s.y),V.map.depthTexture=new Ms(s.x,s.y,Gi)),V.map.depthTexture.name=q.name+".shadowMap",V.map.depthTexture.format=bs,this.type===Pr?(V.map.depthTexture.compareFunction=Z?Df:Lf,V.map.depthTexture.minFilter=Vn,V.map.depthTexture.magFilter=Vn):(V.map.depthTexture.compareFunction=null,V.map.depthTexture.minFilter=Bn,V.map.depthTexture.magFilter=Bn);V.camera.updateProjectionMatrix()}V.map.isWebGLCubeRenderTarget!==!0&&(V.map.width!==s.x||V.map.height!==s.y)&&V.map.setSize(s.x,s.y);let j=V.map.isWebGLCubeRenderTarget?6:V.getViewportCount();q.isPointLight!==!0&&V.updateMatrices(q,T);let et=(V.camera.layers.mask&4294967294)!==0?V.camera.layers:T.layers;for(let dt=0;dt<j;dt++){let ut=V.getCamera(dt);if(q.isPointLight){let tt=V.camera,gt=V.matrix,vt=q.distance||tt.far;vt!==tt.far&&(tt.far=vt,tt.updateProjectionMatrix()),tl.setFromMatrixPosition(q.matrixWorld),tt.position.copy(tl),$f.copy(tt.position),$f.add(dA[dt]),tt.up.copy(fA[dt]),tt.lookAt($f),tt.updateMatrixWorld(),gt.makeTranslation(-tl.x,-tl.y,-tl.z),uy.multiplyMatrices(tt.projectionMatrix,tt.matrixWorldInverse),V._frustum.setFromProjectionMatrix(uy,tt.coordinateSystem,tt.reversedDepth)}if(V.map.isWebGLCubeRenderTarget)i.setRenderTarget(V.map,dt),i.clear();else{dt===0&&(i.setRenderTarget(V.map),i.clear());let tt=V.getViewport(dt);o.set(r.x*tt.x,r.y*tt.y,r.x*tt.z,r.y*tt.w),B.viewport(o)}n=V.getFrustum(dt),y(v,T,ut,q,et,this.type)}V.isPointLightShadow!==!0&&this.type===Bo&&b(V,T),V.needsUpdate=!1}_=this.type,g.needsUpdate=!1,i.setRenderTarget(F,L,D)};function b(E,v){let T=t.update(x);u.defines.VSM_SAMPLES!==E.blurSamples&&(u.defines.VSM_SAMPLES=E.blurSamples,p.defines.VSM_SAMPLES=E.blurSamples,u.needsUpdate=!0,p.needsUpdate=!0),E.mapPass===null?E.mapPass=new xi(s.x,s.y,{format:lr,type:Vi}):(E.mapPass.width!==E.map.width||E.mapPass.height!==E.map.height)&&E.mapPass.setSize(E.map.width,E.map.height),u.uniforms.shadow_pass.value=E.map.depthTexture,u.uniforms.resolution.value.set(E.map.width,E.map.height),u.uniforms.radius.value=E.radius,i.setRenderTarget(E.mapPass),i.clear(),i.renderBufferDirect(v,null,T,u,x,null),p.uniforms.shadow_pass.value=E.mapPass.texture,p.uniforms.resolution.value.set(E.map.width,E.map.height),p.uniforms.radius.value=E.radius,i.setRenderTarget(E.map),i.clear(),i.renderBufferDirect(v,null,T,p,x,null)}function S(E,v,T,F){let L=null,D=T.isPointLight===!0?E.customDistanceMaterial:E.customDepthMaterial;if(D!==void 0)L=D;else if(L=T.isPointLight===!0?l:a,i.localClippingEnabled&&v.clipShadows===!0&&Array.isArray(v.clippingPlanes)&&v.clippingPlanes.length!==0||v.displacementMap&&v.displacementScale!==0||v.alphaMap&&v.alphaTest>0||v.map&&v.alphaTest>0||v.alphaToCoverage===!0){let B=L.uuid,G=v.uuid,N=c[B];N===void 0&&(N={},c[B]=N);let W=N[G];W===void 0&&(W=L.clone(),N[G]=W,v.addEventListener("dispose",C)),L=W}if(L.visible=v.visible,L.wireframe=v.wireframe,F===Bo?L.side=v.shadowSide!==null?v.shadowSide:v.side:L.side=v.shadowSide!==null?v.shadowSide:d[v.side],L.alphaMap=v.alphaMap,L.alphaTest=v.alphaToCoverage===!0?.5:v.alphaTest,L.map=v.map,L.clipShadows=v.clipShadows,L.clippingPlanes=v.clippingPlanes,L.clipIntersection=v.clipIntersection,L.displacementMap=v.displacementMap,L.displacementScale=v.displacementScale,L.displacementBias=v.displacementBias,L.wireframeLinewidth=v.wireframeLinewidth,L.linewidth=v.linewidth,T.isPointLight===!0&&L.isMeshDistanceMaterial===!0){let B=i.properties.get(L);B.light=T}return L}function y(E,v,T,F,L,D){if(E.visible===!1)return;if(E.layers.test(L)&&(E.isMesh||E.isLine||E.isPoints)&&(E.castShadow||E.receiveShadow&&D===Bo)&&(!E.frustumCulled||E.intersectsFrustum(n))){E.modelViewMatrix.multiplyMatrices(T.matrixWorldInverse,E.matrixWorld);let N=t.update(E),W=E.material;if(Array.isArray(W)){let q=N.groups;for(let V=0,lt=q.length;V<lt;V++){let Z=q[V],j=W[Z.materialIndex];if(j&&j.visible){let et=S(E,j,F,D);E.onBeforeShadow(i,E,v,T,N,et,Z),i.renderBufferDirect(T,null,N,et,E,Z),E.onAfterShadow(i,E,v,T,N,et,Z)}}}else if(W.visible){let q=S(E,W,F,D);E.onBeforeShadow(i,E,v,T,N,q,null),i.renderBufferDirect(T,null,N,q,E,null),E.onAfterShadow(i,E,v,T,N,q,null)}}let G=E.children;for(let N=0,W=G.length;N<W;N++)y(G[N],v,T,F,L,D)}function C(E){E.target.removeEventListener("dispose",C);for(let T in c){let F=c[T],L=E.target.uuid;L in F&&(F[L].dispose(),delete F[L])}}}function mA(i,t){function e(){let O=!1,rt=new Qe,it=null,Et=new Qe(0,0,0,0);return{setMask:function(_t){it!==_t&&!O&&(i.colorMask(_t,_t,_t,_t),it=_t)},setLocked:function(_t){O=_t},setClear:function(_t,wt,Wt,jt,ct){ct===!0&&(_t*=jt,wt*=jt,Wt*=jt),rt.set(_t,wt,Wt,jt),Et.equals(rt)===!1&&(i.clearColor(_t,wt,Wt,jt),Et.copy(rt))},reset:function(){O=!1,it=null,Et.set(-1,0,0,0)}}}function n(){let O=!1,rt=!1,it=null,Et=null,_t=null;return{setReversed:function(wt){if(rt!==wt){let Wt=t.get("EXT_clip_control");wt?Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.ZERO_TO_ONE_EXT):Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.NEGATIVE_ONE_TO_ONE_EXT),rt=wt;let jt=_t;_t=null,this.setClear(jt)}},getReversed:function(){return rt},setTest:function(wt){wt?St(i.DEPTH_TEST):$t(i.DEPTH_TEST)},setMask:function(wt){it!==wt&&!O&&(i.depthMask(wt),it=wt)},setFunc:function(wt){if(rt&&(wt=N_[wt]),Et!==wt){switch(wt){case Cc:i.depthFunc(i.NEVER);break;case Pc:i.depthFunc(i.ALWAYS);break;case Ic:i.depthFunc(i.LESS);break;case To:i.depthFunc(i.LEQUAL);break;case Lc:i.depthFunc(i.EQUAL);break;case Dc:i.depthFunc(i.GEQUAL);break;case Nc:i.depthFunc(i.GREATER);break;case Uc:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}Et=wt}},setLocked:function(wt){O=wt},setClear:function(wt){_t!==wt&&(_t=wt,rt&&(wt=1-wt),i.clearDepth(wt))},reset:function(){O=!1,it=null,Et=null,_t=null,rt=!1}}}function s(){let O=!1,rt=null,it=null,Et=null,_t=null,wt=null,Wt=null,jt=null,ct=null;return{setTest:function(kt){O||(kt?St(i.STENCIL_TEST):$t(i.STENCIL_TEST))},setMask:function(kt){rt!==kt&&!O&&(i.stencilMask(kt),rt=kt)},setFunc:function(kt,Qt,Ct){(it!==kt||Et!==Qt||_t!==Ct)&&(i.stencilFunc(kt,Qt,Ct),it=kt,Et=Qt,_t=Ct)},setOp:function(kt,Qt,Ct){(wt!==kt||Wt!==Qt||jt!==Ct)&&(i.stencilOp(kt,Qt,Ct),wt=kt,Wt=Qt,jt=Ct)},setLocked:function(kt){O=kt},setClear:function(kt){ct!==kt&&(i.clearStencil(kt),ct=kt)},reset:function(){O=!1,rt=null,it=null,Et=null,_t=null,wt=null,Wt=null,jt=null,ct=null}}}let r=new e,o=new n,a=new s,l={},c=new WeakMap,h={},d={},u={},p=new WeakMap,m=[],x=null,g=!1,_=null,b=null,S=null,y=null,C=null,E=null,v=null,T=new Zt(0,0,0),F=0,L=!1,D=null,B=null,G=null,N=null,W=null,q=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),V=!1,lt=0,Z=i.getParameter(i.VERSION);Z.indexOf("WebGL")!==-1?(lt=parseFloat(/^WebGL (\d)/.exec(Z)[1]),V=lt>=1):Z.indexOf("OpenGL ES")!==-1&&(lt=parseFloat(/^OpenGL ES (\d)/.exec(Z)[1]),V=lt>=2);let j=null,et={},dt=i.getParameter(i.SCISSOR_BOX),ut=i.getParameter(i.VIEWPORT),tt=new Qe().fromArray(dt),gt=new Qe().fromArray(ut);function vt(O,rt,it,Et){let _t=new Uint8Array(4),wt=i.createTexture();i.bindTexture(O,wt),i.texParameteri(O,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(O,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let Wt=0;Wt<it;Wt++)O===i.TEXTURE_3D||O===i.TEXTURE_2D_ARRAY?i.texImage3D(rt,0,i.RGBA,1,1,Et,0,i.RGBA,i.UNSIGNED_BYTE,_t):i.texImage2D(rt+Wt,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,_t);return wt}let Rt={};Rt[i.TEXTURE_2D]=vt(i.TEXTURE_2D,i.TEXTURE_2D,1),Rt[i.TEXTURE_CUBE_MAP]=vt(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),Rt[i.TEXTURE_2D_ARRAY]=vt(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),Rt[i.TEXTURE_3D]=vt(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),St(i.DEPTH_TEST),o.setFunc(To),mn(!1),Oe(uf),St(i.CULL_FACE),Je(Ir);function St(O){h[O]!==!0&&(i.enable(O),h[O]=!0)}function $t(O){h[O]!==!1&&(i.disable(O),h[O]=!1)}function re(O,rt){return u[O]!==rt?(i.bindFramebuffer(O,rt),u[O]=rt,O===i.DRAW_FRAMEBUFFER&&(u[i.FRAMEBUFFER]=rt),O===i.FRAMEBUFFER&&(u[i.DRAW_FRAMEBUFFER]=rt),!0):!1}function Gt(O,rt){let it=m,Et=!1;if(O){it=p.get(rt),it===void 0&&(it=[],p.set(rt,it));let _t=O.textures;if(it.length!==_t.length||it[0]!==i.COLOR_ATTACHMENT0){for(let wt=0,Wt=_t.length;wt<Wt;wt++)it[wt]=i.COLOR_ATTACHMENT0+wt;it.length=_t.length,Et=!0}}else it[0]!==i.BACK&&(it[0]=i.BACK,Et=!0);Et&&i.drawBuffers(it)}function de(O){return x!==O?(i.useProgram(O),x=O,!0):!1}let le={[Lr]:i.FUNC_ADD,[n_]:i.FUNC_SUBTRACT,[i_]:i.FUNC_REVERSE_SUBTRACT};le[s_]=i.MIN,le[r_]=i.MAX;let ie={[o_]:i.ZERO,[a_]:i.ONE,[l_]:i.SRC_COLOR,[mf]:i.SRC_ALPHA,[p_]:i.SRC_ALPHA_SATURATE,[d_]:i.DST_COLOR,[h_]:i.DST_ALPHA,[c_]:i.ONE_MINUS_SRC_COLOR,[gf]:i.ONE_MINUS_SRC_ALPHA,[f_]:i.ONE_MINUS_DST_COLOR,[u_]:i.ONE_MINUS_DST_ALPHA,[m_]:i.CONSTANT_COLOR,[g_]:i.ONE_MINUS_CONSTANT_COLOR,[__]:i.CONSTANT_ALPHA,[y_]:i.ONE_MINUS_CONSTANT_ALPHA};function Je(O,rt,it,Et,_t,wt,Wt,jt,ct,kt){if(O===Ir){g===!0&&($t(i.BLEND),g=!1);return}if(g===!1&&(St(i.BLEND),g=!0),O!==e_){if(O!==_||kt!==L){if((b!==Lr||C!==Lr)&&(i.blendEquation(i.FUNC_ADD),b=Lr,C=Lr),kt)switch(O){case zo:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case df:i.blendFunc(i.ONE,i.ONE);break;case ff:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case pf:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:te("WebGLState: Invalid blending: ",O);break}else switch(O){case zo:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case df:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case ff:te("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case pf:te("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:te("WebGLState: Invalid blending: ",O);break}S=null,y=null,E=null,v=null,T.set(0,0,0),F=0,_=O,L=kt}return}_t=_t||rt,wt=wt||it,Wt=Wt||Et,(rt!==b||_t!==C)&&(i.blendEquationSeparate(le[rt],le[_t]),b=rt,C=_t),(it!==S||Et!==y||wt!==E||Wt!==v)&&(i.blendFuncSeparate(ie[it],ie[Et],ie[wt],ie[Wt]),S=it,y=Et,E=wt,v=Wt),(jt.equals(T)===!1||ct!==F)&&(i.blendColor(jt.r,jt.g,jt.b,ct),T.copy(jt),F=ct),_=O,L=!1}function We(O,rt){O.side===$n?$t(i.CULL_FACE):St(i.CULL_FACE);let it=O.side===li;rt&&(it=!it),mn(it),O.blending===zo&&O.transparent===!1?Je(Ir):Je(O.blending,O.blendEquation,O.blendSrc,O.blendDst,O.blendEquationAlpha,O.blendSrcAlpha,O.blendDstAlpha,O.blendColor,O.blendAlpha,O.premultipliedAlpha),o.setFunc(O.depthFunc),o.setTest(O.depthTest),o.setMask(O.depthWrite),r.setMask(O.colorWrite);let Et=O.stencilWrite;a.setTest(Et),Et&&(a.setMask(O.stencilWriteMask),a.setFunc(O.stencilFunc,O.stencilRef,O.stencilFuncMask),a.setOp(O.stencilFail,O.stencilZFail,O.stencilZPass)),be(O.polygonOffset,O.polygonOffsetFactor,O.polygonOffsetUnits),O.alphaToCoverage===!0?St(i.SAMPLE_ALPHA_TO_COVERAGE):$t(i.SAMPLE_ALPHA_TO_COVERAGE)}function mn(O){D!==O&&(O?i.frontFace(i.CW):i.frontFace(i.CCW),D=O)}function Oe(O){O!==j0?(St(i.CULL_FACE),O!==B&&(O===uf?i.cullFace(i.BACK):O===Q0?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):$t(i.CULL_FACE),B=O}function Dn(O){O!==G&&(V&&i.lineWidth(O),G=O)}function be(O,rt,it){O?(St(i.POLYGON_OFFSET_FILL),(N!==rt||W!==it)&&(N=rt,W=it,o.getReversed()&&(rt=-rt,it=-it),i.polygonOffset(rt,it))):$t(i.POLYGON_OFFSET_FILL)}function Mn(O){O?St(i.SCISSOR_TEST):$t(i.SCISSOR_TEST)}function on(O){O===void 0&&(O=i.TEXTURE0+q-1),j!==O&&(i.activeTexture(O),j=O)}function gn(O,rt,it){it===void 0&&(j===null?it=i.TEXTURE0+q-1:it=j);let Et=et[it];Et===void 0&&(Et={type:void 0,texture:void 0},et[it]=Et),(Et.type!==O||Et.texture!==rt)&&(j!==it&&(i.activeTexture(it),j=it),i.bindTexture(O,rt||Rt[O]),Et.type=O,Et.texture=rt)}function k(){let O=et[j];O!==void 0&&O.type!==void 0&&(i.bindTexture(O.type,null),O.type=void 0,O.texture=void 0)}function Pt(){try{i.compressedTexImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Kt(){try{i.compressedTexImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function oe(){try{i.texSubImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Mt(){try{i.texSubImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function Be(){try{i.compressedTexSubImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Ht(){try{i.compressedTexSubImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function qt(){try{i.texStorage2D(...arguments)}catch(O){te("WebGLState:",O)}}function P(){try{i.texStorage3D(...arguments)}catch(O){te("WebGLState:",O)}}function M(){try{i.texImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function X(){try{i.texImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function ht(O){return d[O]!==void 0?d[O]:i.getParameter(O)}function ot(O,rt){d[O]!==rt&&(i.pixelStorei(O,rt),d[O]=rt)}function yt(O){tt.equals(O)===!1&&(i.scissor(O.x,O.y,O.z,O.w),tt.copy(O))}function xt(O){gt.equals(O)===!1&&(i.viewport(O.x,O.y,O.z,O.w),gt.copy(O))}function nt(O,rt){let it=c.get(rt);it===void 0&&(it=new WeakMap,c.set(rt,it));let Et=it.get(O);Et===void 0&&(Et=i.getUniformBlockIndex(rt,O.name),i.uniformBlockBinding(rt,Et,Et),it.set(O,Et))}function st(O,rt,it){let _t=c.get(rt).get(O);l[_t]!==it&&(i.bindBufferBase(i.UNIFORM_BUFFER,_t,it),l[_t]=it)}function mt(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),h={},d={},j=null,et={},u={},l={},p=new WeakMap,m=[],x=null,g=!1,_=null,b=null,S=null,y=null,C=null,E=null,v=null,T=new Zt(0,0,0),F=0,L=!1,D=null,B=null,G=null,N=null,W=null,tt.set(0,0,i.canvas.width,i.canvas.height),gt.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:St,disable:$t,bindFramebuffer:re,drawBuffers:Gt,useProgram:de,setBlending:Je,setMaterial:We,setFlipSided:mn,setCullFace:Oe,setLineWidth:Dn,setPolygonOffset:be,setScissorTest:Mn,activeTexture:on,bindTexture:gn,unbindTexture:k,compressedTexImage2D:Pt,compressedTexImage3D:Kt,texImage2D:M,texImage3D:X,pixelStorei:ot,getParameter:ht,updateUBOMapping:nt,uniformBlockBinding:st,texStorage2D:qt,texStorage3D:P,texSubImage2D:oe,texSubImage3D:Mt,compressedTexSubImage2D:Be,compressedTexSubImage3D:Ht,scissor:yt,viewport:xt,reset:mt}}function gA(i,t,e,n,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new Vt,h=new WeakMap,d=new Set,u,p=new WeakMap,m=new Set,x=new FinalizationRegistry(P=>m.delete(P)),g=!1;try{g=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function _(P,M){return g?new OffscreenCanvas(P,M):wa("canvas")}function b(P,M,X){let ht=1,ot=qt(P);if((ot.width>X||ot.height>X)&&(ht=X/Math.max(ot.width,ot.height)),ht<1)if(typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&P instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&P instanceof ImageBitmap||typeof VideoFrame<"u"&&P instanceof VideoFrame){let yt=Math.floor(ht*ot.width),xt=Math.floor(ht*ot.height);u===void 0&&(u=_(yt,xt));let nt=M?_(yt,xt):u;return nt.width=yt,nt.height=xt,nt.getContext("2d").drawImage(P,0,0,yt,xt),Yt("WebGLRenderer: Texture has been resized from ("+ot.width+"x"+ot.height+") to ("+yt+"x"+xt+")."),nt}else return"data"in P&&Yt("WebGLRenderer: Image in DataTexture is too big ("+ot.width+"x"+ot.height+")."),P;return P}function S(P){return P.generateMipmaps}function y(P){i.generateMipmap(P)}function C(P){return P.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:P.isWebGL3DRenderTarget?i.TEXTURE_3D:P.isWebGLArrayRenderTarget||P.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function E(P,M,X,ht,ot,yt=!1){if(P!==null){if(i[P]!==void 0)return i[P];Yt("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+P+"'")}let xt;ht&&(xt=t.get("EXT_texture_norm16"),xt||Yt("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let nt=M;if(M===i.RED&&(X===i.FLOAT&&(nt=i.R32F),X===i.HALF_FLOAT&&(nt=i.R16F),X===i.UNSIGNED_BYTE&&(nt=i.R8),X===i.UNSIGNED_SHORT&&xt&&(nt=xt.R16_EXT),X===i.SHORT&&xt&&(nt=xt.R16_SNORM_EXT)),M===i.RED_INTEGER&&(X===i.UNSIGNED_BYTE&&(nt=i.R8UI),X===i.UNSIGNED_SHORT&&(nt=i.R16UI),X===i.UNSIGNED_INT&&(nt=i.R32UI),X===i.BYTE&&(nt=i.R8I),X===i.SHORT&&(nt=i.R16I),X===i.INT&&(nt=i.R32I)),M===i.RG&&(X===i.FLOAT&&(nt=i.RG32F),X===i.HALF_FLOAT&&(nt=i.RG16F),X===i.UNSIGNED_BYTE&&(nt=i.RG8),X===i.UNSIGNED_SHORT&&xt&&(nt=xt.RG16_EXT),X===i.SHORT&&xt&&(nt=xt.RG16_SNORM_EXT)),M===i.RG_INTEGER&&(X===i.UNSIGNED_BYTE&&(nt=i.RG8UI),X===i.UNSIGNED_SHORT&&(nt=i.RG16UI),X===i.UNSIGNED_INT&&(nt=i.RG32UI),X===i.BYTE&&(nt=i.RG8I),X===i.SHORT&&(nt=i.RG16I),X===i.INT&&(nt=i.RG32I)),M===i.RGB_INTEGER&&(X===i.UNSIGNED_BYTE&&(nt=i.RGB8UI),X===i.UNSIGNED_SHORT&&(nt=i.RGB16UI),X===i.UNSIGNED_INT&&(nt=i.RGB32UI),X===i.BYTE&&(nt=i.RGB8I),X===i.SHORT&&(nt=i.RGB16I),X===i.INT&&(nt=i.RGB32I)),M===i.RGBA_INTEGER&&(X===i.UNSIGNED_BYTE&&(nt=i.RGBA8UI),X===i.UNSIGNED_SHORT&&(nt=i.RGBA16UI),X===i.UNSIGNED_INT&&(nt=i.RGBA32UI),X===i.BYTE&&(nt=i.RGBA8I),X===i.SHORT&&(nt=i.RGBA16I),X===i.INT&&(nt=i.RGBA32I)),M===i.RGB&&(X===i.UNSIGNED_SHORT&&xt&&(nt=xt.RGB16_EXT),X===i.SHORT&&xt&&(nt=xt.RGB16_SNORM_EXT),X===i.UNSIGNED_INT_5_9_9_9_REV&&(nt=i.RGB9_E5),X===i.UNSIGNED_INT_10F_11F_11F_REV&&(nt=i.R11F_G11F_B10F)),M===i.RGBA){let st=yt?ba:xe.getTransfer(ot);X===i.FLOAT&&(nt=i.RGBA32F),X===i.HALF_FLOAT&&(nt=i.RGBA16F),X===i.UNSIGNED_BYTE&&(nt=st===Pe?i.SRGB8_ALPHA8:i.RGBA8),X===i.UNSIGNED_SHORT&&xt&&(nt=xt.RGBA16_EXT),X===i.SHORT&&xt&&(nt=xt.RGBA16_SNORM_EXT),X===i.UNSIGNED_SHORT_4_4_4_4&&(nt=i.RGBA4),X===i.UNSIGNED_SHORT_5_5_5_1&&(nt=i.RGB5_A1)}return(nt===i.R16F||nt===i.R32F||nt===i.RG16F||nt===i.RG32F||nt===i.RGBA16F||nt===i.RGBA32F)&&t.get("EXT_color_buffer_float"),nt}function v(P,M){let X;return P?M===null||M===Gi||M===Nr?X=i.DEPTH24_STENCIL8:M===Jn?X=i.DEPTH32F_STENCIL8:M===Go&&(X=i.DEPTH24_STENCIL8,Yt("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):M===null||M===Gi||M===Nr?X=i.DEPTH_COMPONENT24:M===Jn?X=i.DEPTH_COMPONENT32F:M===Go&&(X=i.DEPTH_COMPONENT16),X}function T(P,M){return S(P)===!0||P.isFramebufferTexture&&P.minFilter!==Bn&&P.minFilter!==Vn?Math.log2(Math.max(M.width,M.height))+1:P.mipmaps.length>0?P.mipmaps.length:P.isCompressedTexture&&Array.isArray(P.image)?M.mipmaps.length:1}function F(P){let M=new WeakRef(P);n.get(P).__ref=M,m.add(M),x.register(P,M,M)}function L(P){let M=n.get(P).__ref;M!==void 0&&(m.delete(M),x.unregister(M))}function D(P){G(P.target)}function B(P){N(P.target)}function G(P){P.removeEventListener("dispose",D),L(P),q(P),P.isVideoTexture&&h.delete(P),P.isHTMLTexture&&d.delete(P)}function N(P){P.removeEventListener("dispose",B),L(P),lt(P)}function W(){for(let P of m){let M=P.deref();M!==void 0&&(M.isRenderTarget===!0?N(M):G(M))}m.clear(),d.clear()}function q(P){let M=n.get(P);if(M.__webglInit===void 0)return;let X=P.source,ht=p.get(X);if(ht){let ot=ht[M.__cacheKey];ot.usedTimes--,ot.usedTimes===0&&V(P),Object.keys(ht).length===0&&p.delete(X)}n.remove(P)}function V(P){let M=n.get(P);i.deleteTexture(M.__webglTexture);let X=P.source,ht=p.get(X);delete ht[M.__cacheKey],o.memory.textures--}function lt(P){let M=n.get(P);M.__depthDisposeCallback&&M.__depthDisposeCallback();let X=P.depthTexture;if(X&&X.renderTarget===P&&G(X),P.isWebGLCubeRenderTarget)for(let ot=0;ot<6;ot++){if(Array.isArray(M.__webglFramebuffer[ot]))for(let yt=0;yt<M.__webglFramebuffer[ot].length;yt++)i.deleteFramebuffer(M.__webglFramebuffer[ot][yt]);else i.deleteFramebuffer(M.__webglFramebuffer[ot]);M.__webglDepthbuffer&&i.deleteRenderbuffer(M.__webglDepthbuffer[ot])}else{if(Array.isArray(M.__webglFramebuffer))for(let ot=0;ot<M.__webglFramebuffer.length;ot++)i.deleteFramebuffer(M.__webglFramebuffer[ot]);else i.deleteFramebuffer(M.__webglFramebuffer);if(M.__webglDepthbuffer&&i.deleteRenderbuffer(M.__webglDepthbuffer),M.__webglMultisampledFramebuffer&&i.deleteFramebuffer(M.__webglMultisampledFramebuffer),M.__webglColorRenderbuffer)for(let ot=0;ot<M.__webglColorRenderbuffer.length;ot++)M.__webglColorRenderbuffer[ot]&&i.deleteRenderbuffer(M.__webglColorRenderbuffer[ot]);M.__webglDepthRenderbuffer&&i.deleteRenderbuffer(M.__webglDepthRenderbuffer)}let ht=P.textures;for(let ot=0,yt=ht.length;ot<yt;ot++){let xt=n.get(ht[ot]);xt.__webglTexture&&(i.deleteTexture(xt.__webglTexture),o.memory.textures--),n.remove(ht[ot])}n.remove(P)}let Z=0;function j(){Z=0}function et(){return Z}function dt(P){Z=P}function ut(){let P=Z;return P>=s.maxTextures&&Yt("WebGLTextures: Trying to use "+(P+1)+" texture units while this GPU supports only "+s.maxTextures),Z+=1,P}function tt(P){let M=[];return M.push(P.wrapS),M.push(P.wrapT),M.push(P.wrapR||0),M.push(P.magFilter),M.push(P.minFilter),M.push(P.anisotropy),M.push(P.internalFormat),M.push(P.format),M.push(P.type),M.push(P.generateMipmaps),M.push(P.mipmapsAutoUpdate),M.push(P.premultiplyAlpha),M.push(P.flipY),M.push(P.unpackAlignment),M.push(P.colorSpace),M.join()}function gt(P,M){let X=n.get(P);if(P.isVideoTexture&&Be(P),P.isRenderTargetTexture===!1&&P.isExternalTexture!==!0&&P.version>0&&X.__version!==P.version){let ht=P.image;if(ht===null)Yt("WebGLRenderer: Texture marked for update but no image data found.");else if(ht.complete===!1)Yt("WebGLRenderer: Texture marked for update but image is incomplete");else{We(X,P,M);return}}else P.isExternalTexture&&(X.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(i.TEXTURE_2D,X.__webglTexture,i.TEXTURE0+M)}function vt(P,M){let X=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&X.__version!==P.version){We(X,P,M);return}else P.isExternalTexture&&(X.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(i.TEXTURE_2D_ARRAY,X.__webglTexture,i.TEXTURE0+M)}function Rt(P,M){let X=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&X.__version!==P.version){We(X,P,M);return}e.bindTexture(i.TEXTURE_3D,X.__webglTexture,i.TEXTURE0+M)}function St(P,M){let X=n.get(P);if(P.version>0&&X.__version!==P.version){mn(X,P,M);return}e.bindTexture(i.TEXTURE_CUBE_MAP,X.__webglTexture,i.TEXTURE0+M)}let $t={[Ao]:i.REPEAT,[Qi]:i.CLAMP_TO_EDGE,[Fc]:i.MIRRORED_REPEAT},re={[Bn]:i.NEAREST,[b_]:i.NEAREST_MIPMAP_NEAREST,[Xa]:i.NEAREST_MIPMAP_LINEAR,[Vn]:i.LINEAR,[ch]:i.LINEAR_MIPMAP_NEAREST,[Ts]:i.LINEAR_MIPMAP_LINEAR},Gt={[E_]:i.NEVER,[Nf]:i.ALWAYS,[T_]:i.LESS,[Lf]:i.LEQUAL,[A_]:i.EQUAL,[Df]:i.GEQUAL,[R_]:i.GREATER,[C_]:i.NOTEQUAL};function de(P,M){if(M.type===Jn&&t.has("OES_texture_float_linear")===!1&&(M.magFilter===Vn||M.magFilter===ch||M.magFilter===Xa||M.magFilter===Ts||M.minFilter===Vn||M.minFilter===ch||M.minFilter===Xa||M.minFilter===Ts)&&Yt("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(P,i.TEXTURE_WRAP_S,$t[M.wrapS]),i.texParameteri(P,i.TEXTURE_WRAP_T,$t[M.wrapT]),(P===i.TEXTURE_3D||P===i.TEXTURE_2D_ARRAY)&&i.texParameteri(P,i.TEXTURE_WRAP_R,$t[M.wrapR]),i.texParameteri(P,i.TEXTURE_MAG_FILTER,re[M.magFilter]),i.texParameteri(P,i.TEXTURE_MIN_FILTER,re[M.minFilter]),M.compareFunction&&(i.texParameteri(P,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(P,i.TEXTURE_COMPARE_FUNC,Gt[M.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(M.magFilter===Bn||M.minFilter!==Xa&&M.minFilter!==Ts||M.type===Jn&&t.has("OES_texture_float_linear")===!1)return;if(M.anisotropy>1||n.get(M).__currentAnisotropy){let X=t.get("EXT_texture_filter_anisotropic");i.texParameterf(P,X.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(M.anisotropy,s.getMaxAnisotropy())),n.get(M).__currentAnisotropy=M.anisotropy}}}function le(P,M){let X=!1;P.__webglInit===void 0&&(P.__webglInit=!0,M.addEventListener("dispose",D),F(M));let ht=M.source,ot=p.get(ht);ot===void 0&&(ot={},p.set(ht,ot));let yt=tt(M);if(yt!==P.__cacheKey){ot[yt]===void 0&&(ot[yt]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,X=!0),ot[yt].usedTimes++;let xt=ot[P.__cacheKey];xt!==void 0&&(ot[P.__cacheKey].usedTimes--,xt.usedTimes===0&&V(M)),P.__cacheKey=yt,P.__webglTexture=ot[yt].texture}return X}function ie(P,M,X){return Math.floor(Math.floor(P/X)/M)}function Je(P,M,X,ht){let yt=P.updateRanges;if(yt.length===0)e.texSubImage2D(i.TEXTURE_2D,0,0,0,M.width,M.height,X,ht,M.data);else{yt.sort((O,rt)=>O.start-rt.start);let xt=0;for(let O=1;O<yt.length;O++){let rt=yt[xt],it=yt[O],Et=rt.start+rt.count,_t=ie(it.start,M.width,4),wt=ie(rt.start,M.width,4);it.start<=Et+1&&_t===wt&&ie(it.start+it.count-1,M.width,4)===_t?rt.count=Math.max(rt.count,it.start+it.count-rt.start):(++xt,yt[xt]=it)}yt.length=xt+1;let nt=e.getParameter(i.UNPACK_ROW_LENGTH),st=e.getParameter(i.UNPACK_SKIP_PIXELS),mt=e.getParameter(i.UNPACK_SKIP_ROWS);e.pixelStorei(i.UNPACK_ROW_LENGTH,M.width);for(let O=0,rt=yt.length;O<rt;O++){let it=yt[O],Et=Math.floor(it.start/4),_t=Math.ceil(it.count/4),wt=Et%M.width,Wt=Math.floor(Et/M.width),jt=_t,ct=1;e.pixelStorei(i.UNPACK_SKIP_PIXELS,wt),e.pixelStorei(i.UNPACK_SKIP_ROWS,Wt),e.texSubImage2D(i.TEXTURE_2D,0,wt,Wt,jt,ct,X,ht,M.data)}P.clearUpdateRanges(),e.pixelStorei(i.UNPACK_ROW_LENGTH,nt),e.pixelStorei(i.UNPACK_SKIP_PIXELS,st),e.pixelStorei(i.UNPACK_SKIP_ROWS,mt)}}function We(P,M,X){let ht=i.TEXTURE_2D;(M.isDataArrayTexture||M.isCompressedArrayTexture)&&(ht=i.TEXTURE_2D_ARRAY),M.isData3DTexture&&(ht=i.TEXTURE_3D);let ot=le(P,M),yt=M.source;e.bindTexture(ht,P.__webglTexture,i.TEXTURE0+X);let xt=n.get(yt);if(yt.version!==xt.__version||ot===!0){if(e.activeTexture(i.TEXTURE0+X),(typeof ImageBitmap<"u"&&M.image instanceof ImageBitmap)===!1){let ct=xe.getPrimaries(xe.workingColorSpace),kt=M.colorSpace===Rs?null:xe.getPrimaries(M.colorSpace),Qt=M.colorSpace===Rs||ct===kt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,M.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,M.premultiplyAlpha),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Qt)}e.pixelStorei(i.UNPACK_ALIGNMENT,M.unpackAlignment);let st=b(M.image,!1,s.maxTextureSize);st=Ht(M,st);let mt=r.convert(M.format,M.colorSpace),O=r.convert(M.type),rt=E(M.internalFormat,mt,O,M.normalized,M.colorSpace,M.isVideoTexture);de(ht,M);let it,Et=M.mipmaps,_t=M.isVideoTexture!==!0,wt=xt.__version===void 0||ot===!0,Wt=yt.dataReady,jt=T(M,st);if(M.isDepthTexture)rt=v(M.format===As,M.type),wt&&(_t?e.texStorage2D(i.TEXTURE_2D,1,rt,st.width,st.height):e.texImage2D(i.TEXTURE_2D,0,rt,st.width,st.height,0,mt,O,null));else if(M.isDataTexture)if(Et.length>0){_t&&wt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,Et[0].width,Et[0].height);for(let ct=0,kt=Et.length;ct<kt;ct++)it=Et[ct],_t?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,mt,O,it.data):e.texImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,mt,O,it.data);M.generateMipmaps=!1}else _t?(wt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,st.width,st.height),Wt&&Je(M,st,mt,O)):e.texImage2D(i.TEXTURE_2D,0,rt,st.width,st.height,0,mt,O,st.data);else if(M.isCompressedTexture)if(M.isCompressedArrayTexture){_t&&wt&&e.texStorage3D(i.TEXTURE_2D_ARRAY,jt,rt,Et[0].width,Et[0].height,st.depth);for(let ct=0,kt=Et.length;ct<kt;ct++)if(it=Et[ct],M.format!==Cn)if(mt!==null)if(_t){if(Wt)if(M.layerUpdates.size>0){let Qt=Vf(it.width,it.height,M.format,M.type);for(let Ct of M.layerUpdates){let ae=it.data.subarray(Ct*Qt/it.data.BYTES_PER_ELEMENT,(Ct+1)*Qt/it.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,Ct,it.width,it.height,1,mt,ae)}}else e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,0,it.width,it.height,st.depth,mt,it.data)}else e.compressedTexImage3D(i.TEXTURE_2D_ARRAY,ct,rt,it.width,it.height,st.depth,0,it.data,0,0);else Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else _t?Wt&&e.texSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,0,it.width,it.height,st.depth,mt,O,it.data):e.texImage3D(i.TEXTURE_2D_ARRAY,ct,rt,it.width,it.height,st.depth,0,mt,O,it.data);M.layerUpdates.size>0&&M.clearLayerUpdates()}else{_t&&wt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,Et[0].width,Et[0].height);for(let ct=0,kt=Et.length;ct<kt;ct++)it=Et[ct],M.format!==Cn?mt!==null?_t?Wt&&e.compressedTexSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,mt,it.data):e.compressedTexImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,it.data):Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):_t?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,mt,O,it.data):e.texImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,mt,O,it.data)}else if(M.isDataArrayTexture)if(_t){if(wt&&e.texStorage3D(i.TEXTURE_2D_ARRAY,jt,rt,st.width,st.height,st.depth),Wt)if(M.layerUpdates.size>0){let ct=Vf(st.width,st.height,M.format,M.type);for(let kt of M.layerUpdates){let Qt=st.data.subarray(kt*ct/st.data.BYTES_PER_ELEMENT,(kt+1)*ct/st.data.BYTES_PER_ELEMENT);e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,kt,st.width,st.height,1,mt,O,Qt)}M.clearLayerUpdates()}else e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,st.width,st.height,st.depth,mt,O,st.data)}else e.texImage3D(i.TEXTURE_2D_ARRAY,0,rt,st.width,st.height,st.depth,0,mt,O,st.data);else if(M.isData3DTexture)_t?(wt&&e.texStorage3D(i.TEXTURE_3D,jt,rt,st.width,st.height,st.depth),Wt&&e.texSubImage3D(i.TEXTURE_3D,0,0,0,0,st.width,st.height,st.depth,mt,O,st.data)):e.texImage3D(i.TEXTURE_3D,0,rt,st.width,st.height,st.depth,0,mt,O,st.data);else if(M.isFramebufferTexture){if(wt)if(_t)e.texStorage2D(i.TEXTURE_2D,jt,rt,st.width,st.height);else{let ct=st.width,kt=st.height;for(let Qt=0;Qt<jt;Qt++)e.texImage2D(i.TEXTURE_2D,Qt,rt,ct,kt,0,mt,O,null),ct>>=1,kt>>=1}}else if(M.isHTMLTexture){if("texElementImage2D"in i){let ct=i.canvas;if(ct.hasAttribute("layoutsubtree")||ct.setAttribute("layoutsubtree","true"),st.parentNode!==ct){ct.appendChild(st),d.add(M),ct.onpaint=kt=>{let Qt=kt.changedElements;for(let Ct of d)Qt.includes(Ct.image)&&(Ct.needsUpdate=!0)},ct.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,st);else{let Qt=i.RGBA,Ct=i.RGBA,ae=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,Qt,Ct,ae,st)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(Et.length>0){if(_t&&wt){let ct=qt(Et[0]);e.texStorage2D(i.TEXTURE_2D,jt,rt,ct.width,ct.height)}for(let ct=0,kt=Et.length;ct<kt;ct++)it=Et[ct],_t?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,mt,O,it):e.texImage2D(i.TEXTURE_2D,ct,rt,mt,O,it);M.generateMipmaps=!1}else if(_t){if(wt){let ct=qt(st);e.texStorage2D(i.TEXTURE_2D,jt,rt,ct.width,ct.height)}Wt&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,mt,O,st)}else e.texImage2D(i.TEXTURE_2D,0,rt,mt,O,st);S(M)&&M.mipmapsAutoUpdate===!0&&y(ht),xt.__version=yt.version,M.onUpdate&&M.onUpdate(M)}P.__version=M.version}function mn(P,M,X){if(M.image.length!==6)return;let ht=le(P,M),ot=M.source;e.bindTexture(i.TEXTURE_CUBE_MAP,P.__webglTexture,i.TEXTURE0+X);let yt=n.get(ot);if(ot.version!==yt.__version||ht===!0){e.activeTexture(i.TEXTURE0+X);let xt=xe.getPrimaries(xe.workingColorSpace),nt=M.colorSpace===Rs?null:xe.getPrimaries(M.colorSpace),st=M.colorSpace===Rs||xt===nt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,M.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,M.premultiplyAlpha),e.pixelStorei(i.UNPACK_ALIGNMENT,M.unpackAlignment),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,st);let mt=M.isCompressedTexture||M.image[0].isCompressedTexture,O=M.image[0]&&M.image[0].isDataTexture,rt=[];for(let Ct=0;Ct<6;Ct++)!mt&&!O?rt[Ct]=b(M.image[Ct],!0,s.maxCubemapSize):rt[Ct]=O?M.image[Ct].image:M.image[Ct],rt[Ct]=Ht(M,rt[Ct]);let it=rt[0],Et=r.convert(M.format,M.colorSpace),_t=r.convert(M.type),wt=E(M.internalFormat,Et,_t,M.normalized,M.colorSpace),Wt=M.isVideoTexture!==!0,jt=yt.__version===void 0||ht===!0,ct=ot.dataReady,kt=T(M,it);de(i.TEXTURE_CUBE_MAP,M);let Qt;if(M.isDepthTexture){if(wt=v(M.format===As,M.type),jt)if(Wt)e.texStorage2D(i.TEXTURE_CUBE_MAP,1,wt,it.width,it.height);else for(let Ct=0;Ct<6;Ct++)e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,it.width,it.height,0,Et,_t,null)}else if(mt){Wt&&jt&&e.texStorage2D(i.TEXTURE_CUBE_MAP,kt,wt,it.width,it.height);for(let Ct=0;Ct<6;Ct++){Qt=rt[Ct].mipmaps;for(let ae=0;ae<Qt.length;ae++){let $e=Qt[ae];M.format!==Cn?Et!==null?Wt?ct&&e.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae,0,0,$e.width,$e.height,Et,$e.data):e.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae,wt,$e.width,$e.height,0,$e.data):Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae,0,0,$e.width,$e.height,Et,_t,$e.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae,wt,$e.width,$e.height,0,Et,_t,$e.data)}}}else{if(Qt=M.mipmaps,Wt&&jt){Qt.length>0&&kt++;let Ct=qt(rt[0]);e.texStorage2D(i.TEXTURE_CUBE_MAP,kt,wt,Ct.width,Ct.height)}for(let Ct=0;Ct<6;Ct++)if(O){Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,0,0,rt[Ct].width,rt[Ct].height,Et,_t,rt[Ct].data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,rt[Ct].width,rt[Ct].height,0,Et,_t,rt[Ct].data);for(let ae=0;ae<Qt.length;ae++){let Qn=Qt[ae].image[Ct].image;Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae+1,0,0,Qn.width,Qn.height,Et,_t,Qn.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae+1,wt,Qn.width,Qn.height,0,Et,_t,Qn.data)}}else{Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,0,0,Et,_t,rt[Ct]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,0,wt,Et,_t,rt[Ct]);for(let ae=0;ae<Qt.length;ae++){let $e=Qt[ae];Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae+1,0,0,Et,_t,$e.image[Ct]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ct,ae+1,wt,Et,_t,$e.image[Ct])}}}S(M)&&M.mipmapsAutoUpdate===!0&&y(i.TEXTURE_CUBE_MAP),yt.__version=ot.version,M.onUpdate&&M.onUpdate(M)}P.__version=M.version}function Oe(P,M,X,ht,ot,yt){let xt=r.convert(X.format,X.colorSpace),nt=r.convert(X.type),st=E(X.internalFormat,xt,nt,X.normalized,X.colorSpace),mt=n.get(M),O=n.get(X);if(O.__renderTarget=M,!mt.__hasExternalTextures){let rt=Math.max(1,M.width>>yt),it=Math.max(1,M.height>>yt);ot===i.TEXTURE_3D||ot===i.TEXTURE_2D_ARRAY?e.texImage3D(ot,yt,st,rt,it,M.depth,0,xt,nt,null):e.texImage2D(ot,yt,st,rt,it,0,xt,nt,null)}e.bindFramebuffer(i.FRAMEBUFFER,P),Mt(M)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,ht,ot,O.__webglTexture,0,oe(M)):(ot===i.TEXTURE_2D||ot>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&ot<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,ht,ot,O.__webglTexture,yt),e.bindFramebuffer(i.FRAMEBUFFER,null)}function Dn(P,M,X){if(i.bindRenderbuffer(i.RENDERBUFFER,P),M.depthBuffer){let ht=M.depthTexture,ot=ht&&ht.isDepthTexture?ht.type:null,yt=v(M.stencilBuffer,ot),xt=M.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;Mt(M)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,oe(M),yt,M.width,M.height):X?i.renderbufferStorageMultisample(i.RENDERBUFFER,oe(M),yt,M.width,M.height):i.renderbufferStorage(i.RENDERBUFFER,yt,M.width,M.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,xt,i.RENDERBUFFER,P)}else{let ht=M.textures;for(let ot=0;ot<ht.length;ot++){let yt=ht[ot],xt=r.convert(yt.format,yt.colorSpace),nt=r.convert(yt.type),st=E(yt.internalFormat,xt,nt,yt.normalized,yt.colorSpace);Mt(M)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,oe(M),st,M.width,M.height):X?i.renderbufferStorageMultisample(i.RENDERBUFFER,oe(M),st,M.width,M.height):i.renderbufferStorage(i.RENDERBUFFER,st,M.width,M.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function be(P,M,X){let ht=M.isWebGLCubeRenderTarget===!0;if(e.bindFramebuffer(i.FRAMEBUFFER,P),!(M.depthTexture&&M.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let ot=n.get(M.depthTexture);ot.__renderTarget=M;let yt=ht?M.depthTexture.image[0]:M.depthTexture.image;(!ot.__webglTexture||yt.width!==M.width||yt.height!==M.height)&&(yt.width=M.width,yt.height=M.height,M.depthTexture.needsUpdate=!0),ht?St(M.depthTexture,0):gt(M.depthTexture,0);let xt=ot.__webglTexture,nt=oe(M),st=ht?i.TEXTURE_CUBE_MAP_POSITIVE_X+X:i.TEXTURE_2D,mt=M.depthTexture.format===As?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(M.depthTexture.format===bs)Mt(M)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,mt,st,xt,0,nt):i.framebufferTexture2D(i.FRAMEBUFFER,mt,st,xt,0);else if(M.depthTexture.format===As)Mt(M)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,mt,st,xt,0,nt):i.framebufferTexture2D(i.FRAMEBUFFER,mt,st,xt,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function Mn(P){let M=n.get(P),X=P.isWebGLCubeRenderTarget===!0;if(M.__boundDepthTexture!==P.depthTexture){let ht=P.depthTexture;if(M.__depthDisposeCallback&&M.__depthDisposeCallback(),ht){let ot=()=>{delete M.__boundDepthTexture,delete M.__depthDisposeCallback,ht.removeEventListener("dispose",ot)};ht.addEventListener("dispose",ot),M.__depthDisposeCallback=ot}M.__boundDepthTexture=ht}if(P.depthTexture&&!M.__autoAllocateDepthBuffer)if(X)for(let ht=0;ht<6;ht++)be(M.__webglFramebuffer[ht],P,ht);else P.texture.mipmaps.length>0?be(M.__webglFramebuffer[0],P,0):be(M.__webglFramebuffer,P,0);else if(X){M.__webglDepthbuffer=[];for(let ht=0;ht<6;ht++)if(e.bindFramebuffer(i.FRAMEBUFFER,M.__webglFramebuffer[ht]),M.__webglDepthbuffer[ht]===void 0)M.__webglDepthbuffer[ht]=i.createRenderbuffer(),Dn(M.__webglDepthbuffer[ht],P,!1);else{let ot=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,yt=M.__webglDepthbuffer[ht];i.bindRenderbuffer(i.RENDERBUFFER,yt),i.framebufferRenderbuffer(i.FRAMEBUFFER,ot,i.RENDERBUFFER,yt)}}else if(P.texture.mipmaps.length>0?e.bindFramebuffer(i.FRAMEBUFFER,M.__webglFramebuffer[0]):e.bindFramebuffer(i.FRAMEBUFFER,M.__webglFramebuffer),M.__webglDepthbuffer===void 0)M.__webglDepthbuffer=i.createRenderbuffer(),Dn(M.__webglDepthbuffer,P,!1);else{let ot=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,yt=M.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,yt),i.framebufferRenderbuffer(i.FRAMEBUFFER,ot,i.RENDERBUFFER,yt)}e.bindFramebuffer(i.FRAMEBUFFER,null)}function on(P,M,X){let ht=n.get(P);M!==void 0&&Oe(ht.__webglFramebuffer,P,P.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),X!==void 0&&Mn(P)}function gn(P){let M=P.texture,X=n.get(P),ht=n.get(M);P.addEventListener("dispose",B),F(P);let ot=P.textures,yt=P.isWebGLCubeRenderTarget===!0,xt=ot.length>1;if(xt||(ht.__webglTexture===void 0&&(ht.__webglTexture=i.createTexture()),ht.__version=M.version,o.memory.textures++),yt){X.__webglFramebuffer=[];for(let nt=0;nt<6;nt++)if(M.mipmaps.length>0){X.__webglFramebuffer[nt]=[];for(let st=0;st<M.mipmaps.length;st++)X.__webglFramebuffer[nt][st]=i.createFramebuffer()}else X.__webglFramebuffer[nt]=i.createFramebuffer()}else{if(M.mipmaps.length>0){X.__webglFramebuffer=[];for(let nt=0;nt<M.mipmaps.length;nt++)X.__webglFramebuffer[nt]=i.createFramebuffer()}else X.__webglFramebuffer=i.createFramebuffer();if(xt)for(let nt=0,st=ot.length;nt<st;nt++){let mt=n.get(ot[nt]);mt.__webglTexture===void 0&&(mt.__webglTexture=i.createTexture(),o.memory.textures++)}if(P.samples>0&&Mt(P)===!1){X.__webglMultisampledFramebuffer=i.createFramebuffer(),X.__webglColorRenderbuffer=[],e.bindFramebuffer(i.FRAMEBUFFER,X.__webglMultisampledFramebuffer);for(let nt=0;nt<ot.length;nt++){let st=ot[nt];X.__webglColorRenderbuffer[nt]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,X.__webglColorRenderbuffer[nt]);let mt=r.convert(st.format,st.colorSpace),O=r.convert(st.type),rt=E(st.internalFormat,mt,O,st.normalized,st.colorSpace,P.isXRRenderTarget===!0),it=oe(P);i.renderbufferStorageMultisample(i.RENDERBUFFER,it,rt,P.width,P.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+nt,i.RENDERBUFFER,X.__webglColorRenderbuffer[nt])}i.bindRenderbuffer(i.RENDERBUFFER,null),P.depthBuffer&&(X.__webglDepthRenderbuffer=i.createRenderbuffer(),Dn(X.__webglDepthRenderbuffer,P,!0)),e.bindFramebuffer(i.FRAMEBUFFER,null)}}if(yt){e.bindTexture(i.TEXTURE_CUBE_MAP,ht.__webglTexture),de(i.TEXTURE_CUBE_MAP,M);for(let nt=0;nt<6;nt++)if(M.mipmaps.length>0)for(let st=0;st<M.mipmaps.length;st++)Oe(X.__webglFramebuffer[nt][st],P,M,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+nt,st);else Oe(X.__webglFramebuffer[nt],P,M,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+nt,0);S(M)?y(i.TEXTURE_CUBE_MAP):M.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,M.mipmaps.length-1),e.unbindTexture()}else if(xt){for(let nt=0,st=ot.length;nt<st;nt++){let mt=ot[nt],O=n.get(mt),rt=i.TEXTURE_2D;(P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(rt=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(rt,O.__webglTexture),de(rt,mt),Oe(X.__webglFramebuffer,P,mt,i.COLOR_ATTACHMENT0+nt,rt,0),S(mt)&&y(rt)}e.unbindTexture()}else{let nt=i.TEXTURE_2D;if((P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(nt=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(nt,ht.__webglTexture),de(nt,M),M.mipmaps.length>0)for(let st=0;st<M.mipmaps.length;st++)Oe(X.__webglFramebuffer[st],P,M,i.COLOR_ATTACHMENT0,nt,st);else Oe(X.__webglFramebuffer,P,M,i.COLOR_ATTACHMENT0,nt,0);S(M)?y(nt):M.mipmaps.length>0&&i.texParameteri(nt,i.TEXTURE_MAX_LEVEL,M.mipmaps.length-1),e.unbindTexture()}P.depthBuffer&&Mn(P)}function k(P){let M=P.textures;for(let X=0,ht=M.length;X<ht;X++){let ot=M[X];if(S(ot)&&ot.mipmapsAutoUpdate===!0){let yt=C(P),xt=n.get(ot).__webglTexture;e.bindTexture(yt,xt),y(yt),e.unbindTexture()}}}let Pt=[];function Kt(P){if(P.samples>0){if(Mt(P)===!1){let M=P.textures,X=P.width,ht=P.height,ot=i.COLOR_BUFFER_BIT,yt=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,xt=n.get(P),nt=M.length>1;if(nt)for(let mt=0;mt<M.length;mt++)e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+mt,i.RENDERBUFFER,null),e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+mt,i.TEXTURE_2D,null,0);e.bindFramebuffer(i.READ_FRAMEBUFFER,xt.__webglMultisampledFramebuffer),P.texture.mipmaps.length>0?e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglFramebuffer[0]):e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglFramebuffer);for(let mt=0;mt<M.length;mt++){if(P.resolveDepthBuffer&&(P.depthBuffer&&(ot|=i.DEPTH_BUFFER_BIT),P.stencilBuffer&&P.resolveStencilBuffer&&(ot|=i.STENCIL_BUFFER_BIT)),nt){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,xt.__webglColorRenderbuffer[mt]);let O=n.get(M[mt]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,O,0)}i.blitFramebuffer(0,0,X,ht,0,0,X,ht,ot,i.NEAREST),l===!0&&(Pt.length=0,Pt.push(i.COLOR_ATTACHMENT0+mt),P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&Pt.push(yt),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Pt))}if(e.bindFramebuffer(i.READ_FRAMEBUFFER,null),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),nt)for(let mt=0;mt<M.length;mt++){e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+mt,i.RENDERBUFFER,xt.__webglColorRenderbuffer[mt]);let O=n.get(M[mt]).__webglTexture;e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+mt,i.TEXTURE_2D,O,0)}e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglMultisampledFramebuffer)}else if(P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&l){let M=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[M])}}}function oe(P){return Math.min(s.maxSamples,P.samples)}function Mt(P){let M=n.get(P);return P.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&M.__useRenderToTexture!==!1}function Be(P){let M=o.render.frame;h.get(P)!==M&&(h.set(P,M),P.update())}function Ht(P,M){let X=P.colorSpace,ht=P.format,ot=P.type;return P.isCompressedTexture===!0||P.isVideoTexture===!0||X!==xa&&X!==Rs&&(xe.getTransfer(X)===Pe?(ht!==Cn||ot!==ci)&&Yt("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):te("WebGLTextures: Unsupported texture color space:",X)),M}function qt(P){return typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement?(c.width=P.naturalWidth||P.width,c.height=P.naturalHeight||P.height):typeof VideoFrame<"u"&&P instanceof VideoFrame?(c.width=P.displayWidth,c.height=P.displayHeight):(c.width=P.width,c.height=P.height),c}this.allocateTextureUnit=ut,this.resetTextureUnits=j,this.getTextureUnits=et,this.setTextureUnits=dt,this.setTexture2D=gt,this.setTexture2DArray=vt,this.setTexture3D=Rt,this.setTextureCube=St,this.rebindTextures=on,this.setupRenderTarget=gn,this.updateRenderTargetMipmap=k,this.updateMultisampleRenderTarget=Kt,this.setupDepthRenderbuffer=Mn,this.setupFrameBufferTexture=Oe,this.useMultisampledRTT=Mt,this.dispose=W}function _A(i,t){function e(n,s=Rs){let r,o=xe.getTransfer(s);if(n===ci)return i.UNSIGNED_BYTE;if(n===uh)return i.UNSIGNED_SHORT_4_4_4_4;if(n===dh)return i.UNSIGNED_SHORT_5_5_5_1;if(n===Af)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===Rf)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===Ef)return i.BYTE;if(n===Tf)return i.SHORT;if(n===Go)return i.UNSIGNED_SHORT;if(n===hh)return i.INT;if(n===Gi)return i.UNSIGNED_INT;if(n===Jn)return i.FLOAT;if(n===Vi)return i.HALF_FLOAT;if(n===Cf)return i.ALPHA;if(n===Pf)return i.RGB;if(n===Cn)return i.RGBA;if(n===bs)return i.DEPTH_COMPONENT;if(n===As)return i.DEPTH_STENCIL;if(n===If)return i.RED;if(n===fh)return i.RED_INTEGER;if(n===lr)return i.RG;if(n===ph)return i.RG_INTEGER;if(n===mh)return i.RGBA_INTEGER;if(n===qa||n===Ya||n===Za||n===Ka)if(o===Pe)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===qa)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Ya)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===Za)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===Ka)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===qa)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Ya)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===Za)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===Ka)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===gh||n===_h||n===yh||n===vh)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===gh)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===_h)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===yh)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===vh)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===xh||n===bh||n===wh||n===Sh||n===Mh||n===Ja||n===Eh)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(n===xh||n===bh)return o===Pe?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===wh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===Sh)return r.COMPRESSED_R11_EAC;if(n===Mh)return r.COMPRESSED_SIGNED_R11_EAC;if(n===Ja)return r.COMPRESSED_RG11_EAC;if(n===Eh)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===Th||n===Ah||n===Rh||n===Ch||n===Ph||n===Ih||n===Lh||n===Dh||n===Nh||n===Uh||n===Fh||n===Oh||n===kh||n===Bh)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(n===Th)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===Ah)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===Rh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===Ch)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===Ph)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===Ih)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===Lh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===Dh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===Nh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===Uh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===Fh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===Oh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===kh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===Bh)return o===Pe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===zh||n===Hh||n===Gh)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(n===zh)return o===Pe?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===Hh)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===Gh)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===Vh||n===Wh||n===ja||n===$h)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(n===Vh)return r.COMPRESSED_RED_RGTC1_EXT;if(n===Wh)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===ja)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===$h)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===Nr?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:e}}var yA=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,vA=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,jf=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e){if(this.texture===null){let n=new La(t.texture);(t.depthNear!==e.depthNear||t.depthFar!==e.depthFar)&&(this.depthNear=t.depthNear,this.depthFar=t.depthFar),this.texture=n}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,n=new Ci({vertexShader:yA,fragmentShader:vA,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new Ie(new Es(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Qf=class extends Bi{constructor(t,e){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,d=null,u=null,p=null,m=null,x=typeof XRWebGLBinding<"u",g=new jf,_={},b=e.getContextAttributes(),S=null,y=null,C=[],E=[],v=new Vt,T=null,F=null,L=new oi;L.viewport=new Qe;let D=new oi;D.viewport=new Qe;let B=[L,D],G=new rh,N=null,W=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(tt){let gt=C[tt];return gt===void 0&&(gt=new Do,C[tt]=gt),gt.getTargetRaySpace()},this.getControllerGrip=function(tt){let gt=C[tt];return gt===void 0&&(gt=new Do,C[tt]=gt),gt.getGripSpace()},this.getHand=function(tt){let gt=C[tt];return gt===void 0&&(gt=new Do,C[tt]=gt),gt.getHandSpace()};function q(tt){let gt=E.indexOf(tt.inputSource);if(gt===-1)return;let vt=C[gt];vt!==void 0&&(vt.update(tt.inputSource,tt.frame,c||o),vt.dispatchEvent({type:tt.type,data:tt.inputSource}))}function V(){s.removeEventListener("select",q),s.removeEventListener("selectstart",q),s.removeEventListener("selectend",q),s.removeEventListener("squeeze",q),s.removeEventListener("squeezestart",q),s.removeEventListener("squeezeend",q),s.removeEventListener("end",V),s.removeEventListener("inputsourceschange",lt);for(let tt=0;tt<C.length;tt++){let gt=E[tt];gt!==null&&(E[tt]=null,C[tt].disconnect(gt))}N=null,W=null,g.reset();for(let tt in _)delete _[tt];if(t.setRenderTarget(S),p=null,u=null,d=null,s=null,y=null,ut.stop(),n.isPresenting=!1,t.setPixelRatio(T),t.setSize(v.width,v.height,!1),F!==null){let tt=F.camera;tt.fov=F.fov,tt.zoom=F.zoom,tt.updateProjectionMatrix(),F=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(tt){r=tt,n.isPresenting===!0&&Yt("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(tt){a=tt,n.isPresenting===!0&&Yt("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(tt){c=tt},this.getBaseLayer=function(){return u!==null?u:p},this.getBinding=function(){return d===null&&x&&(d=new XRWebGLBinding(s,e)),d},this.getFrame=function(){return m},this.getSession=function(){return s},this.setSession=async function(tt){if(s=tt,s!==null){if(S=t.getRenderTarget(),s.addEventListener("select",q),s.addEventListener("selectstart",q),s.addEventListener("selectend",q),s.addEventListener("squeeze",q),s.addEventListener("squeezestart",q),s.addEventListener("squeezeend",q),s.addEventListener("end",V),s.addEventListener("inputsourceschange",lt),b.xrCompatible!==!0&&await e.makeXRCompatible(),T=t.getPixelRatio(),t.getSize(v),x&&"createProjectionLayer"in XRWebGLBinding.prototype){let vt=null,Rt=null,St=null;b.depth&&(St=b.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,vt=b.stencil?As:bs,Rt=b.stencil?Nr:Gi);let $t={colorFormat:e.RGBA8,depthFormat:St,scaleFactor:r};d=this.getBinding(),u=d.createProjectionLayer($t),s.updateRenderState({layers:[u]}),t.setPixelRatio(1),t.setSize(u.textureWidth,u.textureHeight,!1),y=new xi(u.textureWidth,u.textureHeight,{format:Cn,type:ci,depthTexture:new Ms(u.textureWidth,u.textureHeight,Rt,void 0,void 0,void 0,void 0,void 0,void 0,vt),stencilBuffer:b.stencil,colorSpace:t.outputColorSpace,samples:b.antialias?4:0,resolveDepthBuffer:u.ignoreDepthValues===!1,resolveStencilBuffer:u.ignoreDepthValues===!1,storeMultisampledDepthBuffer:u.ignoreDepthValues===!1,storeMultisampledStencilBuffer:u.ignoreDepthValues===!1})}else{let vt={antialias:b.antialias,alpha:!0,depth:b.depth,stencil:b.stencil,framebufferScaleFactor:r};p=new XRWebGLLayer(s,e,vt),s.updateRenderState({baseLayer:p}),t.setPixelRatio(1),t.setSize(p.framebufferWidth,p.framebufferHeight,!1),y=new xi(p.framebufferWidth,p.framebufferHeight,{format:Cn,type:ci,colorSpace:t.outputColorSpace,stencilBuffer:b.stencil,resolveDepthBuffer:p.ignoreDepthValues===!1,resolveStencilBuffer:p.ignoreDepthValues===!1,storeMultisampledDepthBuffer:p.ignoreDepthValues===!1,storeMultisampledStencilBuffer:p.ignoreDepthValues===!1})}y.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),ut.setContext(s),ut.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return g.getDepthTexture()};function lt(tt){for(let gt=0;gt<tt.removed.length;gt++){let vt=tt.removed[gt],Rt=E.indexOf(vt);Rt>=0&&(E[Rt]=null,C[Rt].disconnect(vt))}for(let gt=0;gt<tt.added.length;gt++){let vt=tt.added[gt],Rt=E.indexOf(vt);if(Rt===-1){for(let $t=0;$t<C.length;$t++)if($t>=E.length){E.push(vt),Rt=$t;break}else if(E[$t]===null){E[$t]=vt,Rt=$t;break}if(Rt===-1)break}let St=C[Rt];St&&St.connect(vt)}}function Z(tt,gt){gt===null?tt.matrixWorld.copy(tt.matrix):tt.matrixWorld.multiplyMatrices(gt.matrixWorld,tt.matrix),tt.matrixWorldInverse.copy(tt.matrixWorld).invert()}this.updateCamera=function(tt){if(s===null)return;let gt=tt.near,vt=tt.far;g.texture!==null&&(g.depthNear>0&&(gt=g.depthNear),g.depthFar>0&&(vt=g.depthFar)),G.near=D.near=L.near=gt,G.far=D.far=L.far=vt,(N!==G.near||W!==G.far)&&(s.updateRenderState({depthNear:G.near,depthFar:G.far}),N=G.near,W=G.far),G.layers.mask=tt.layers.mask|6,L.layers.mask=G.layers.mask&-5,D.layers.mask=G.layers.mask&-3;let Rt=tt.parent,St=G.cameras;Z(G,Rt);for(let $t=0;$t<St.length;$t++)Z(St[$t],Rt);G.projectionMatrix.copy(L.projectionMatrix),G.projectionMatrixInverse.copy(L.projectionMatrixInverse),F===null&&tt.isPerspectiveCamera&&(F={camera:tt,fov:tt.fov,zoom:tt.zoom}),j(tt,G,Rt)};function j(tt,gt,vt){vt===null?tt.matrix.copy(gt.matrixWorld):(tt.matrix.copy(vt.matrixWorld),tt.matrix.invert(),tt.matrix.multiply(gt.matrixWorld)),tt.matrix.decompose(tt.position,tt.quaternion,tt.scale),tt.updateMatrixWorld(!0),tt.projectionMatrix.copy(gt.projectionMatrix),tt.projectionMatrixInverse.copy(gt.projectionMatrixInverse),tt.isPerspectiveCamera&&(tt.fov=Po*2*Math.atan(1/tt.projectionMatrix.elements[5]),tt.zoom=1)}this.getCamera=function(){return G},this.getFoveation=function(){if(!(u===null&&p===null))return l},this.setFoveation=function(tt){l=tt,u!==null&&(u.fixedFoveation=tt),p!==null&&p.fixedFoveation!==void 0&&(p.fixedFoveation=tt)},this.hasDepthSensing=function(){return g.texture!==null},this.getDepthSensingMesh=function(){return g.getMesh(G)},this.getCameraTexture=function(tt){return _[tt]};let et=null;function dt(tt,gt){if(h=gt.getViewerPose(c||o),m=gt,h!==null){let vt=h.views;p!==null&&(t.setRenderTargetFramebuffer(y,p.framebuffer),t.setRenderTarget(y));let Rt=!1;vt.length!==G.cameras.length&&(G.cameras.length=0,Rt=!0);for(let Gt=0;Gt<vt.length;Gt++){let de=vt[Gt],le=null;if(p!==null)le=p.getViewport(de);else{let Je=d.getViewSubImage(u,de);le=Je.viewport,Gt===0&&(t.setRenderTargetTextures(y,Je.colorTexture,Je.depthStencilTexture),t.setRenderTarget(y))}let ie=B[Gt];ie===void 0&&(ie=new oi,ie.layers.enable(Gt),ie.viewport=new Qe,B[Gt]=ie),ie.matrix.fromArray(de.transform.matrix),ie.matrix.decompose(ie.position,ie.quaternion,ie.scale),ie.projectionMatrix.fromArray(de.projectionMatrix),ie.projectionMatrixInverse.copy(ie.projectionMatrix).invert(),ie.viewport.set(le.x,le.y,le.width,le.height),Gt===0&&(G.matrix.copy(ie.matrix),G.matrix.decompose(G.position,G.quaternion,G.scale)),Rt===!0&&G.cameras.push(ie)}let St=s.enabledFeatures;if(St&&St.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&x){d=n.getBinding();let Gt=d.getDepthInformation(vt[0]);Gt&&Gt.isValid&&Gt.texture&&g.init(Gt,s.renderState)}if(St&&St.includes("camera-access")&&x){t.state.unbindTexture(),d=n.getBinding();for(let Gt=0;Gt<vt.length;Gt++){let de=vt[Gt].camera;if(de){let le=_[de];le||(le=new La,_[de]=le);let ie=d.getCameraImage(de);le.sourceTexture=ie}}}}for(let vt=0;vt<C.length;vt++){let Rt=E[vt],St=C[vt];Rt!==null&&St!==void 0&&St.update(Rt,gt,c||o)}et&&et(tt,gt),gt.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:gt}),m=null}let ut=new dy;ut.setAnimationLoop(dt),this.setAnimationLoop=function(tt){et=tt},this.dispose=function(){}}},xA=new Ve,wy=new ne;wy.set(-1,0,0,0,1,0,0,0,1);function bA(i,t){function e(g,_){g.matrixAutoUpdate===!0&&g.updateMatrix(),_.value.copy(g.matrix)}function n(g,_){_.color.getRGB(g.fogColor.value,zf(i)),_.isFog?(g.fogNear.value=_.near,g.fogFar.value=_.far):_.isFogExp2&&(g.fogDensity.value=_.density)}function s(g,_,b,S,y){_.isNodeMaterial?_.uniformsNeedUpdate=!1:_.isMeshBasicMaterial?r(g,_):_.isMeshLambertMaterial?(r(g,_),_.envMap&&(g.envMapIntensity.value=_.envMapIntensity)):_.isMeshToonMaterial?(r(g,_),d(g,_)):_.isMeshPhongMaterial?(r(g,_),h(g,_),_.envMap&&(g.envMapIntensity.value=_.envMapIntensity)):_.isMeshStandardMaterial?(r(g,_),u(g,_),_.isMeshPhysicalMaterial&&p(g,_,y)):_.isMeshMatcapMaterial?(r(g,_),m(g,_)):_.isMeshDepthMaterial?r(g,_):_.isMeshDistanceMaterial?(r(g,_),x(g,_)):_.isMeshNormalMaterial?r(g,_):_.isLineBasicMaterial?(o(g,_),_.isLineDashedMaterial&&a(g,_)):_.isPointsMaterial?l(g,_,b,S):_.isSpriteMaterial?c(g,_):_.isShadowMaterial?(g.color.value.copy(_.color),g.opacity.value=_.opacity):_.isShaderMaterial&&(_.uniformsNeedUpdate=!1)}function r(g,_){g.opacity.value=_.opacity,_.color&&g.diffuse.value.copy(_.color),_.emissive&&g.emissive.value.copy(_.emissive).multiplyScalar(_.emissiveIntensity),_.map&&(g.map.value=_.map,e(_.map,g.mapTransform)),_.alphaMap&&(g.alphaMap.value=_.alphaMap,e(_.alphaMap,g.alphaMapTransform)),_.bumpMap&&(g.bumpMap.value=_.bumpMap,e(_.bumpMap,g.bumpMapTransform),g.bumpScale.value=_.bumpScale,_.side===li&&(g.bumpScale.value*=-1)),_.normalMap&&(g.normalMap.value=_.normalMap,e(_.normalMap,g.normalMapTransform),g.normalScale.value.copy(_.normalScale),_.side===li&&g.normalScale.value.negate()),_.displacementMap&&(g.displacementMap.value=_.displacementMap,e(_.displacementMap,g.displacementMapTransform),g.displacementScale.value=_.displacementScale,g.displacementBias.value=_.displacementBias),_.emissiveMap&&(g.emissiveMap.value=_.emissiveMap,e(_.emissiveMap,g.emissiveMapTransform)),_.specularMap&&(g.specularMap.value=_.specularMap,e(_.specularMap,g.specularMapTransform)),_.alphaTest>0&&(g.alphaTest.value=_.alphaTest);let b=t.get(_),S=b.envMap,y=b.envMapRotation;S&&(g.envMap.value=S,g.envMapRotation.value.setFromMatrix4(xA.makeRotationFromEuler(y)).transpose(),S.isCubeTexture&&S.isRenderTargetTexture===!1&&g.envMapRotation.value.premultiply(wy),g.reflectivity.value=_.reflectivity,g.ior.value=_.ior,g.refractionRatio.value=_.refractionRatio),_.lightMap&&(g.lightMap.value=_.lightMap,g.lightMapIntensity.value=_.lightMapIntensity,e(_.lightMap,g.lightMapTransform)),_.aoMap&&(g.aoMap.value=_.aoMap,g.aoMapIntensity.value=_.aoMapIntensity,e(_.aoMap,g.aoMapTransform))}function o(g,_){g.diffuse.value.copy(_.color),g.opacity.value=_.opacity,_.map&&(g.map.value=_.map,e(_.map,g.mapTransform))}function a(g,_){g.dashSize.value=_.dashSize,g.totalSize.value=_.dashSize+_.gapSize,g.scale.value=_.scale}function l(g,_,b,S){g.diffuse.value.copy(_.color),g.opacity.value=_.opacity,g.size.value=_.size*b,g.scale.value=S*.5,_.map&&(g.map.value=_.map,e(_.map,g.uvTransform)),_.alphaMap&&(g.alphaMap.value=_.alphaMap,e(_.alphaMap,g.alphaMapTransform)),_.alphaTest>0&&(g.alphaTest.value=_.alphaTest)}function c(g,_){g.diffuse.value.copy(_.color),g.opacity.value=_.opacity,g.rotation.value=_.rotation,_.map&&(g.map.value=_.map,e(_.map,g.mapTransform)),_.alphaMap&&(g.alphaMap.value=_.alphaMap,e(_.alphaMap,g.alphaMapTransform)),_.alphaTest>0&&(g.alphaTest.value=_.alphaTest)}function h(g,_){g.specular.value.copy(_.specular),g.shininess.value=Math.max(_.shininess,1e-4)}function d(g,_){_.gradientMap&&(g.gradientMap.value=_.gradientMap)}function u(g,_){g.metalness.value=_.metalness,_.metalnessMap&&(g.metalnessMap.value=_.metalnessMap,e(_.metalnessMap,g.metalnessMapTransform)),g.roughness.value=_.roughness,_.roughnessMap&&(g.roughnessMap.value=_.roughnessMap,e(_.roughnessMap,g.roughnessMapTransform)),_.envMap&&(g.envMapIntensity.value=_.envMapIntensity)}function p(g,_,b){g.ior.value=_.ior,_.diffuseRoughness>0&&(g.diffuseRoughness.value=_.diffuseRoughness,_.diffuseRoughnessMap&&(g.diffuseRoughnessMap.value=_.diffuseRoughnessMap,e(_.diffuseRoughnessMap,g.diffuseRoughnessMapTransform))),_.sheen>0&&(g.sheenColor.value.copy(_.sheenColor).multiplyScalar(_.sheen),g.sheenRoughness.value=_.sheenRoughness,_.sheenColorMap&&(g.sheenColorMap.value=_.sheenColorMap,e(_.sheenColorMap,g.sheenColorMapTransform)),_.sheenRoughnessMap&&(g.sheenRoughnessMap.value=_.sheenRoughnessMap,e(_.sheenRoughnessMap,g.sheenRoughnessMapTransform))),_.clearcoat>0&&(g.clearcoat.value=_.clearcoat,g.clearcoatRoughness.value=_.clearcoatRoughness,_.clearcoatMap&&(g.clearcoatMap.value=_.clearcoatMap,e(_.clearcoatMap,g.clearcoatMapTransform)),_.clearcoatRoughnessMap&&(g.clearcoatRoughnessMap.value=_.clearcoatRoughnessMap,e(_.clearcoatRoughnessMap,g.clearcoatRoughnessMapTransform)),_.clearcoatNormalMap&&(g.clearcoatNormalMap.value=_.clearcoatNormalMap,e(_.clearcoatNormalMap,g.clearcoatNormalMapTransform),g.clearcoatNormalScale.value.copy(_.clearcoatNormalScale),_.side===li&&g.clearcoatNormalScale.value.negate())),_.dispersion>0&&(g.dispersion.value=_.dispersion),_.retroreflectivity>0&&(g.retroreflectivity.value=_.retroreflectivity),_.iridescence>0&&(g.iridescence.value=_.iridescence,g.iridescenceIOR.value=_.iridescenceIOR,g.iridescenceThicknessMinimum.value=_.iridescenceThicknessMinimum,g.iridescenceThicknessMaximum.value=_.iridescenceThicknessMaximum,_.iridescenceMap&&(g.iridescenceMap.value=_.iridescenceMap,e(_.iridescenceMap,g.iridescenceMapTransform)),_.iridescenceThicknessMap&&(g.iridescenceThicknessMap.value=_.iridescenceThicknessMap,e(_.iridescenceThicknessMap,g.iridescenceThicknessMapTransform))),_.transmission>0&&(g.transmission.value=_.transmission,g.transmissionSamplerMap.value=b.texture,g.transmissionSamplerSize.value.set(b.width,b.height),_.transmissionMap&&(g.transmissionMap.value=_.transmissionMap,e(_.transmissionMap,g.transmissionMapTransform)),g.thickness.value=_.thickness,_.thicknessMap&&(g.thicknessMap.value=_.thicknessMap,e(_.thicknessMap,g.thicknessMapTransform)),g.attenuationDistance.value=_.attenuationDistance,g.attenuationColor.value.copy(_.attenuationColor)),_.anisotropy>0&&(g.anisotropyVector.value.set(_.anisotropy*Math.cos(_.anisotropyRotation),_.anisotropy*Math.sin(_.anisotropyRotation)),_.anisotropyMap&&(g.anisotropyMap.value=_.anisotropyMap,e(_.anisotropyMap,g.anisotropyMapTransform))),g.specularIntensity.value=_.specularIntensity,g.specularColor.value.copy(_.specularColor),_.specularColorMap&&(g.specularColorMap.value=_.specularColorMap,e(_.specularColorMap,g.specularColorMapTransform)),_.specularIntensityMap&&(g.specularIntensityMap.value=_.specularIntensityMap,e(_.specularIntensityMap,g.specularIntensityMapTransform))}function m(g,_){_.matcap&&(g.matcap.value=_.matcap)}function x(g,_){let b=t.get(_).light;g.referencePosition.value.setFromMatrixPosition(b.matrixWorld),g.nearDistance.value=b.shadow.camera.near,g.farDistance.value=b.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function wA(i,t,e,n){let s={},r={};function o(b,S){let y=S.program;n.uniformBlockBinding(b,y,s[b.id])}function a(b,S){let y=s[b.id];y===void 0&&(m(b),y=l(b),s[b.id]=y,b.addEventListener("dispose",g));let C=S.program;n.updateUBOMapping(b,C);let E=t.render.frame;r[b.id]!==E&&(c(b),r[b.id]=E)}function l(b){let S=i.createBuffer(),y=b.__size,C=b.usage;return i.bindBuffer(i.UNIFORM_BUFFER,S),i.bufferData(i.UNIFORM_BUFFER,y,C),i.bindBuffer(i.UNIFORM_BUFFER,null),S}function c(b){let S=s[b.id],y=b.uniforms,C=b.__cache;i.bindBuffer(i.UNIFORM_BUFFER,S);for(let E=0,v=y.length;E<v;E++){let T=y[E];if(Array.isArray(T))for(let F=0,L=T.length;F<L;F++)h(T[F],E,F,C);else h(T,E,0,C)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function h(b,S,y,C){if(u(b,S,y,C)===!0){let E=b.__offset,v=b.value;if(Array.isArray(v)){let T=0;for(let F=0;F<v.length;F++){let L=v[F],D=x(L,!0);d(L,b.__data,T),T+=D.storage/Float32Array.BYTES_PER_ELEMENT}}else d(v,b.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,E,b.__data)}}function d(b,S,y){typeof b=="number"||typeof b=="boolean"?S[y]=b:b.isMatrix3?(S[y]=b.elements[0],S[y+1]=b.elements[1],S[y+2]=b.elements[2],S[y+3]=0,S[y+4]=b.elements[3],S[y+5]=b.elements[4],S[y+6]=b.elements[5],S[y+7]=0,S[y+8]=b.elements[6],S[y+9]=b.elements[7],S[y+10]=b.elements[8],S[y+11]=0):ArrayBuffer.isView(b)?S.set(b.subarray(0,S.length-y),y):b.toArray(S,y)}function u(b,S,y,C){let E=b.value,v=S+"_"+y;if(Array.isArray(E)){C[v]===void 0&&(C[v]=[]);let T=C[v],F=!1;for(let L=0;L<E.length;L++)p(E[L],T,L)===!0&&(F=!0);return F}return p(E,C,v)}function p(b,S,y){if(S[y]===void 0)return typeof b=="number"||typeof b=="boolean"?S[y]=b:ArrayBuffer.isView(b)?S[y]=b.slice():S[y]=b.clone(),!0;{let C=S[y];if(typeof b=="number"||typeof b=="boolean"){if(C!==b)return S[y]=b,!0}else{if(ArrayBuffer.isView(b))return!0;if(C.equals(b)===!1)return C.copy(b),!0}}return!1}function m(b){let S=b.uniforms,y=0,C=16;for(let v=0,T=S.length;v<T;v++){let F=Array.isArray(S[v])?S[v]:[S[v]];for(let L=0,D=F.length;L<D;L++){let B=F[L],G=Array.isArray(B.value)?B.value:[B.value],N=Array.isArray(S[v])||Array.isArray(B.value),W=y;for(let V=0,lt=G.length;V<lt;V++){let Z=G[V],j=x(Z,N),et=y%C,dt=et%j.boundary,ut=et+dt;y+=dt,ut!==0&&C-ut<j.storage&&(y+=C-ut),V===0&&(W=y),y+=j.storage}let q=B.type==="int"?Int32Array:B.type==="uint"?Uint32Array:Float32Array;B.__data=new q((y-W)/Float32Array.BYTES_PER_ELEMENT),B.__offset=W}}let E=y%C;return E>0&&(y+=C-E),b.__size=y,b.__cache={},this}function x(b,S){let y={boundary:0,storage:0};return typeof b=="number"||typeof b=="boolean"?(y.boundary=4,y.storage=4):b.isVector2?(y.boundary=8,y.storage=8):b.isVector3||b.isColor?(y.boundary=16,y.storage=12):b.isVector4?(y.boundary=16,y.storage=16):b.isMatrix3?(y.boundary=16,y.storage=48):b.isMatrix4?(y.boundary=16,y.storage=64):b.isTexture?Yt("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(b)?(y.boundary=16,y.storage=b.byteLength):Yt("WebGLRenderer: Unsupported uniform value type.",b),S===!0&&(y.boundary=16,y.storage=Math.ceil(y.storage/16)*16),y}function g(b){let S=b.target;S.removeEventListener("dispose",g),i.deleteBuffer(s[S.id]),delete s[S.id],delete r[S.id]}function _(){for(let b in s)i.deleteBuffer(s[b]);s={},r={}}return{bind:o,update:a,dispose:_}}var SA=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),ns=null;function MA(){return ns===null&&(ns=new Ri(SA,16,16,lr,Vi),ns.name="DFG_LUT",ns.minFilter=Vn,ns.magFilter=Vn,ns.wrapS=Qi,ns.wrapT=Qi,ns.generateMipmaps=!1,ns.needsUpdate=!0),ns}var Zh=class{constructor(t={}){let{canvas:e=I_(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:d=!1,reversedDepthBuffer:u=!1,outputBufferType:p=ci}=t;this.isWebGLRenderer=!0;let m;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");m=n.getContextAttributes().alpha}else m=o;let x=p,g=new Set([mh,ph,fh]),_=new Set([ci,Gi,Go,Nr,uh,dh]),b=new Uint32Array(4),S=new Int32Array(4),y={textures:[],min:[],max:[],resolution:[]},C=null,E=null,v=[],T=[],F=null;this.domElement=e,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=es,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let L=this,D=!1,B=null,G=null,N=null,W=null;this._outputColorSpace=sn;let q=0,V=0,lt=null,Z=-1,j=null,et=new Qe,dt=new Qe,ut=null,tt=new Zt(0),gt=0,vt=e.width,Rt=e.height,St=1,$t=null,re=null,Gt=new Qe(0,0,vt,Rt),de=new Qe(0,0,vt,Rt),le=!1,ie=new Zs,Je=new Hc,We=!1,mn=!1,Oe=new Ve,Dn=new H,be=new Qe,Mn={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},on=!1;function gn(){return lt===null?St:1}let k=n;function Pt(R,z){return e.getContext(R,z)}let Kt,oe,Mt,Be,Ht,qt,P,M,X,ht,ot,yt,xt,nt,st,mt,O,rt,it,Et,_t,wt,Wt;try{let R={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:d};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${"187"}`),e.addEventListener("webglcontextlost",kt,!1),e.addEventListener("webglcontextrestored",Qt,!1),e.addEventListener("webglcontextcreationerror",Ct,!1),k===null){let z="webgl2";if(k=Pt(z,R),k===null)throw Pt(z)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}jt()}catch(R){throw e.removeEventListener("webglcontextlost",kt,!1),e.removeEventListener("webglcontextrestored",Qt,!1),e.removeEventListener("webglcontextcreationerror",Ct,!1),te("WebGLRenderer: "+R.message),R}function jt(){Kt=new UT(k),Kt.init(),_t=new _A(k,Kt),oe=new MT(k,Kt,t,_t),Mt=new mA(k,Kt),oe.reversedDepthBuffer&&u&&Mt.buffers.depth.setReversed(!0),G=k.createFramebuffer(),N=k.createFramebuffer(),W=k.createFramebuffer(),Be=new kT(k),Ht=new eA,qt=new gA(k,Kt,Mt,Ht,oe,_t,Be),P=new NT(L),M=new zS(k),wt=new wT(k,M),X=new FT(k,M,Be,wt),ht=new zT(k,X,M,wt,Be),rt=new BT(k,oe,qt),st=new ET(Ht),ot=new tA(L,P,Kt,oe,wt,st),yt=new bA(L,Ht),xt=new iA,nt=new cA(Kt),O=new bT(L,P,Mt,ht,m,l),mt=new pA(L,ht,oe),Wt=new wA(k,Be,oe,Mt),it=new ST(k,Kt,Be),Et=new OT(k,Kt,Be),Be.programs=ot.programs,L.capabilities=oe,L.extensions=Kt,L.properties=Ht,L.renderLists=xt,L.shadowMap=mt,L.state=Mt,L.info=Be}x!==ci&&(F=new GT(x,e.width,e.height,a,s,r));let ct=new Qf(L,k);this.xr=ct,this.getContext=function(){return k},this.getContextAttributes=function(){return k.getContextAttributes()},this.forceContextLoss=function(){let R=Kt.get("WEBGL_lose_context");R&&R.loseContext()},this.forceContextRestore=function(){let R=Kt.get("WEBGL_lose_context");R&&R.restoreContext()},this.getPixelRatio=function(){return St},this.setPixelRatio=function(R){R!==void 0&&(St=R,this.setSize(vt,Rt,!1))},this.getSize=function(R){return R.set(vt,Rt)},this.setSize=function(R,z,Q=!0){if(ct.isPresenting){Yt("WebGLRenderer: Can't change size while VR device is presenting.");return}vt=R,Rt=z,e.width=Math.floor(R*St),e.height=Math.floor(z*St),Q===!0&&(e.style.width=R+"px",e.style.height=z+"px"),F!==null&&F.setSize(e.width,e.height),this.setViewport(0,0,R,z)},this.getDrawingBufferSize=function(R){return R.set(vt*St,Rt*St).floor()},this.setDrawingBufferSize=function(R,z,Q){vt=R,Rt=z,St=Q,e.width=Math.floor(R*Q),e.height=Math.floor(z*Q),this.setViewport(0,0,R,z)},this.setEffects=function(R){if(x===ci){te("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(R){for(let z=0;z<R.length;z++)if(R[z].isOutputPass===!0){Yt("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}F.setEffects(R||[])},this.getCurrentViewport=function(R){return R.copy(et)},this.getViewport=function(R){return R.copy(Gt)},this.setViewport=function(R,z,Q,Y){R.isVector4?Gt.set(R.x,R.y,R.z,R.w):Gt.set(R,z,Q,Y),Mt.viewport(et.copy(Gt).multiplyScalar(gn()).round())},this.getScissor=function(R){return R.copy(de)},this.setScissor=function(R,z,Q,Y){R.isVector4?de.set(R.x,R.y,R.z,R.w):de.set(R,z,Q,Y),Mt.scissor(dt.copy(de).multiplyScalar(gn()).round())},this.getScissorTest=function(){return le},this.setScissorTest=function(R){Mt.setScissorTest(le=R)},this.setOpaqueSort=function(R){$t=R},this.setTransparentSort=function(R){re=R},this.getClearColor=function(R){return R.copy(O.getClearColor())},this.setClearColor=function(){O.setClearColor(...arguments)},this.getClearAlpha=function(){return O.getClearAlpha()},this.setClearAlpha=function(){O.setClearAlpha(...arguments)},this.clear=function(R=!0,z=!0,Q=!0){let Y=0;if(R){let K=!1;if(lt!==null){let Tt=lt.texture.format;K=g.has(Tt)}if(K){let Tt=lt.texture.type,It=_.has(Tt),At=O.getClearColor(),Lt=O.getClearAlpha(),zt=At.r,ee=At.g,fe=At.b;It?(b[0]=zt,b[1]=ee,b[2]=fe,b[3]=Lt,k.clearBufferuiv(k.COLOR,0,b)):(S[0]=zt,S[1]=ee,S[2]=fe,S[3]=Lt,k.clearBufferiv(k.COLOR,0,S))}else Y|=k.COLOR_BUFFER_BIT}z&&(Y|=k.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),Q&&(Y|=k.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),Y!==0&&k.clear(Y)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(R){R.setRenderer(this),B=R},this.dispose=function(){e.removeEventListener("webglcontextlost",kt,!1),e.removeEventListener("webglcontextrestored",Qt,!1),e.removeEventListener("webglcontextcreationerror",Ct,!1),O.dispose(),xt.dispose(),nt.dispose(),qt.dispose(),Ht.dispose(),P.dispose(),ht.dispose(),X.dispose(),wt.dispose(),Wt.dispose(),ot.dispose(),ct.dispose(),ct.removeEventListener("sessionstart",fl),ct.removeEventListener("sessionend",Wi),rs.stop()};function kt(R){R.preventDefault(),Ff("WebGLRenderer: Context Lost."),D=!0}function Qt(){Ff("WebGLRenderer: Context Restored."),D=!1;let R=Be.autoReset,z=mt.enabled,Q=mt.autoUpdate,Y=mt.needsUpdate,K=mt.type;jt(),Be.autoReset=R,mt.enabled=z,mt.autoUpdate=Q,mt.needsUpdate=Y,mt.type=K}function Ct(R){te("WebGLRenderer: A WebGL context could not be created. Reason: ",R.statusMessage)}function ae(R){let z=R.target;z.removeEventListener("dispose",ae),$e(z)}function $e(R){Qn(R),Ht.remove(R)}function Qn(R){let z=Ht.get(R).programs;z!==void 0&&(z.forEach(function(Q){ot.releaseProgram(Q)}),R.isShaderMaterial&&ot.releaseShaderCache(R))}this.renderBufferDirect=function(R,z,Q,Y,K,Tt){z===null&&(z=Mn);let It=K.isMesh&&K.matrixWorld.determinantAffine()<0,At=Jo(R,z,Q,Y,K);Mt.setMaterial(Y,It);let Lt=Q.index,zt=1;if(Y.wireframe===!0){if(Lt=X.getWireframeAttribute(Q),Lt===void 0)return;zt=2}let ee=Q.drawRange,fe=Q.attributes.position,Bt=ee.start*zt,pe=(ee.start+ee.count)*zt;Tt!==null&&(Bt=Math.max(Bt,Tt.start*zt),pe=Math.min(pe,(Tt.start+Tt.count)*zt)),Lt!==null?(Bt=Math.max(Bt,0),pe=Math.min(pe,Lt.count)):fe!=null&&(Bt=Math.max(Bt,0),pe=Math.min(pe,fe.count));let tn=pe-Bt;if(tn<0||tn===1/0)return;wt.setup(K,Y,At,Q,Lt);let Le,De=it;if(Lt!==null&&(Le=M.get(Lt),De=Et,De.setIndex(Le)),K.isMesh)Y.wireframe===!0?(Mt.setLineWidth(Y.wireframeLinewidth*gn()),De.setMode(k.LINES)):De.setMode(k.TRIANGLES);else if(K.isLine){let En=Y.linewidth;En===void 0&&(En=1),Mt.setLineWidth(En*gn()),K.isLineSegments?De.setMode(k.LINES):K.isLineLoop?De.setMode(k.LINE_LOOP):De.setMode(k.LINE_STRIP)}else K.isPoints?De.setMode(k.POINTS):K.isSprite&&De.setMode(k.TRIANGLES);if(K.isBatchedMesh)if(Kt.get("WEBGL_multi_draw"))De.renderMultiDraw(K._multiDrawStarts,K._multiDrawCounts,K._multiDrawCount);else{let En=K._multiDrawStarts,Ft=K._multiDrawCounts,_n=K._multiDrawCount,ye=Lt?M.get(Lt).bytesPerElement:1,as=Ht.get(Y).currentProgram.getUniforms();for(let yn=0;yn<_n;yn++)as.setValue(k,"_gl_DrawID",yn),De.render(En[yn]/ye,Ft[yn])}else if(K.isInstancedMesh)De.renderInstances(Bt,tn,K.count);else if(Q.isInstancedBufferGeometry){let En=Q._maxInstanceCount!==void 0?Q._maxInstanceCount:1/0,Ft=Math.min(Q.instanceCount,En);De.renderInstances(Bt,tn,Ft)}else De.render(Bt,tn)};function Yo(R,z,Q,Y){B!==null&&R.isNodeMaterial&&B.setObject(Y,R),We===!0&&st.setState(R,Q,!1),R.transparent===!0&&R.side===$n&&R.forceSinglePass===!1?(R.side=li,R.needsUpdate=!0,$i(R,z,Y),R.side=ar,R.needsUpdate=!0,$i(R,z,Y),R.side=$n):$i(R,z,Y)}this.compile=function(R,z,Q=null){Q===null&&(Q=R),B!==null&&B.renderStart(R,z,Q),E=nt.get(Q),E.init(z),T.push(E),Q.traverseVisible(function(K){K.isLight&&K.layers.test(z.layers)&&(E.pushLight(K),K.castShadow&&E.pushShadow(K))}),R!==Q&&R.traverseVisible(function(K){K.isLight&&K.layers.test(z.layers)&&(E.pushLight(K),K.castShadow&&E.pushShadow(K))}),E.setupLights(),B!==null&&B.updateLights(E.state.lightsArray),mn=this.localClippingEnabled,We=st.init(this.clippingPlanes,mn),We===!0&&st.setGlobalState(this.clippingPlanes,z),B!==null&&mt.render(E.state.shadowsArray,Q,z);let Y=new Set;return R.traverse(function(K){if(!(K.isMesh||K.isPoints||K.isLine||K.isSprite))return;let Tt=K.material;if(Tt)if(Array.isArray(Tt))for(let It=0;It<Tt.length;It++){let At=Tt[It];Yo(At,Q,z,K),Y.add(At)}else Yo(Tt,Q,z,K),Y.add(Tt)}),E=T.pop(),B!==null&&B.renderEnd(),Y},this.compileAsync=function(R,z,Q=null){let Y=this.compile(R,z,Q);return new Promise(K=>{function Tt(){if(Y.forEach(function(It){let Lt=Ht.get(It).currentProgram;(Lt===void 0||Lt.isReady())&&Y.delete(It)}),Y.size===0){K(R);return}setTimeout(Tt,10)}Kt.get("KHR_parallel_shader_compile")!==null?Tt():setTimeout(Tt,10)})};let Br=null;function Cu(R){Br&&Br(R)}function fl(){rs.stop()}function Wi(){rs.start()}let rs=new dy;rs.setAnimationLoop(Cu),typeof self<"u"&&rs.setContext(self),this.setAnimationLoop=function(R){Br=R,ct.setAnimationLoop(R),R===null?rs.stop():rs.start()},ct.addEventListener("sessionstart",fl),ct.addEventListener("sessionend",Wi),this.render=function(R,z){if(z!==void 0&&z.isCamera!==!0){te("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(D===!0)return;B!==null&&B.renderStart(R,z);let Q=ct.enabled===!0&&ct.isPresenting===!0,Y=F!==null&&(lt===null||Q)&&F.begin(L,lt);if(R.matrixWorldAutoUpdate===!0&&R.updateMatrixWorld(),z.parent===null&&z.matrixWorldAutoUpdate===!0&&z.updateMatrixWorld(),ct.enabled===!0&&ct.isPresenting===!0&&(F===null||F.isCompositing()===!1)&&(ct.cameraAutoUpdate===!0&&ct.updateCamera(z),z=ct.getCamera()),R.isScene===!0&&R.onBeforeRender(L,R,z,lt),E=nt.get(R,T.length),E.init(z),E.state.textureUnits=qt.getTextureUnits(),T.push(E),Oe.multiplyMatrices(z.projectionMatrix,z.matrixWorldInverse),z.isArrayCamera?Je.setFromArrayCamera(z):ie.setFromProjectionMatrix(Oe,Ai,z.reversedDepth),mn=this.localClippingEnabled,We=st.init(this.clippingPlanes,mn),C=xt.get(R,v.length),C.init(),v.push(C),this.info.render.frame++,ct.enabled===!0&&ct.isPresenting===!0){let It=L.xr.getDepthSensingMesh();It!==null&&os(It,z,-1/0,L.sortObjects)}os(R,z,0,L.sortObjects),C.finish(),B!==null&&B.updateLights(E.state.lightsArray),L.sortObjects===!0&&C.sort($t,re),on=ct.enabled===!1||ct.isPresenting===!1||ct.hasDepthSensing()===!1,on&&O.addToRenderList(C,R),this.info.autoReset===!0&&this.info.reset(),We===!0&&st.beginShadows();let K=E.state.shadowsArray;if(mt.render(K,R,z),We===!0&&st.endShadows(),(Y&&F.hasRenderPass())===!1){let It=C.opaque,At=C.transmissive;if(E.setupLights(),z.isArrayCamera){let Lt=z.cameras;if(At.length>0)for(let zt=0,ee=Lt.length;zt<ee;zt++){let fe=Lt[zt];Pi(It,At,R,fe)}on&&O.render(R);for(let zt=0,ee=Lt.length;zt<ee;zt++){let fe=Lt[zt];Zo(C,R,fe,fe.viewport)}}else At.length>0&&Pi(It,At,R,z),on&&O.render(R),Zo(C,R,z)}lt!==null&&V===0&&(qt.updateMultisampleRenderTarget(lt),qt.updateRenderTargetMipmap(lt)),Y&&F.end(L),R.isScene===!0&&R.onAfterRender(L,R,z),wt.resetDefaultState(),Z=-1,j=null,T.pop(),T.length>0?(E=T[T.length-1],qt.setTextureUnits(E.state.textureUnits),We===!0&&st.setGlobalState(L.clippingPlanes,E.state.camera)):E=null,v.pop(),v.length>0?C=v[v.length-1]:C=null,B!==null&&B.renderEnd()};function os(R,z,Q,Y){if(R.visible===!1)return;if(R.layers.test(z.layers)){if(R.isGroup)Q=R.renderOrder;else if(R.isLOD)R.autoUpdate===!0&&R.update(z);else if(R.isLight)E.pushLight(R),R.castShadow&&E.pushShadow(R);else if(R.isSprite){let It=z.isArrayCamera?Je:ie;if(!R.frustumCulled||R.intersectsFrustum(It)){Y&&be.setFromMatrixPosition(R.matrixWorld).applyMatrix4(Oe);let At=ht.update(R),Lt=R.material;Lt.visible&&C.push(R,At,Lt,Q,be.z,null,z)}}else if(R.isMesh||R.isLine||R.isPoints){let It=z.isArrayCamera?Je:ie;if(!R.frustumCulled||R.intersectsFrustum(It)){let At=ht.update(R),Lt=R.material;if(Y&&(R.boundingSphere!==void 0?(R.boundingSphere===null&&R.computeBoundingSphere(),be.copy(R.boundingSphere.center)):(At.boundingSphere===null&&At.computeBoundingSphere(),be.copy(At.boundingSphere.center)),be.applyMatrix4(R.matrixWorld).applyMatrix4(Oe)),Array.isArray(Lt)){let zt=At.groups;for(let ee=0,fe=zt.length;ee<fe;ee++){let Bt=zt[ee],pe=Lt[Bt.materialIndex];pe&&pe.visible&&C.push(R,At,pe,Q,be.z,Bt,z)}}else Lt.visible&&C.push(R,At,Lt,Q,be.z,null,z)}}}let Tt=R.children;for(let It=0,At=Tt.length;It<At;It++)os(Tt[It],z,Q,Y)}function Zo(R,z,Q,Y){let{opaque:K,transmissive:Tt,transparent:It}=R;E.setupLightsView(Q),We===!0&&st.setGlobalState(L.clippingPlanes,Q),Y&&Mt.viewport(et.copy(Y)),K.length>0&&an(K,z,Q),Tt.length>0&&an(Tt,z,Q),It.length>0&&an(It,z,Q),Mt.buffers.depth.setTest(!0),Mt.buffers.depth.setMask(!0),Mt.buffers.color.setMask(!0),Mt.setPolygonOffset(!1)}function Pi(R,z,Q,Y){if((Q.isScene===!0?Q.overrideMaterial:null)!==null)return;if(E.state.transmissionRenderTarget[Y.id]===void 0){let Bt=Kt.has("EXT_color_buffer_half_float")||Kt.has("EXT_color_buffer_float");E.state.transmissionRenderTarget[Y.id]=new xi(1,1,{generateMipmaps:!0,type:Bt?Vi:ci,minFilter:Ts,samples:Math.max(4,oe.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:xe.workingColorSpace})}let Tt=E.state.transmissionRenderTarget[Y.id],It=Y.viewport||et;Tt.setSize(It.z*L.transmissionResolutionScale,It.w*L.transmissionResolutionScale);let At=L.getRenderTarget(),Lt=L.getActiveCubeFace(),zt=L.getActiveMipmapLevel();L.setRenderTarget(Tt),L.getClearColor(tt),gt=L.getClearAlpha(),gt<1&&L.setClearColor(16777215,.5),L.clear(),on&&O.render(Q);let ee=L.toneMapping;L.toneMapping=es;let fe=Y.viewport;if(Y.viewport!==void 0&&(Y.viewport=void 0),E.setupLightsView(Y),We===!0&&st.setGlobalState(L.clippingPlanes,Y),an(R,Q,Y),qt.updateMultisampleRenderTarget(Tt),qt.updateRenderTargetMipmap(Tt),Kt.has("WEBGL_multisampled_render_to_texture")===!1){let Bt=!1;for(let pe=0,tn=z.length;pe<tn;pe++){let Le=z[pe],{object:De,geometry:En,material:Ft,group:_n}=Le;if(Ft.side===$n&&De.layers.test(Y.layers)){let ye=Ft.side;Ft.side=li,Ft.needsUpdate=!0,fn(De,Q,Y,En,Ft,_n),Ft.side=ye,Ft.needsUpdate=!0,Bt=!0}}Bt===!0&&(qt.updateMultisampleRenderTarget(Tt),qt.updateRenderTargetMipmap(Tt))}L.setRenderTarget(At,Lt,zt),L.setClearColor(tt,gt),fe!==void 0&&(Y.viewport=fe),L.toneMapping=ee}function an(R,z,Q){let Y=z.isScene===!0?z.overrideMaterial:null;for(let K=0,Tt=R.length;K<Tt;K++){let It=R[K],{object:At,geometry:Lt,group:zt}=It,ee=It.material;ee.allowOverride===!0&&Y!==null&&(ee=Y),At.layers.test(Q.layers)&&fn(At,z,Q,Lt,ee,zt)}}function fn(R,z,Q,Y,K,Tt){B!==null&&K.isNodeMaterial&&B.setObject(R,K),R.onBeforeRender(L,z,Q,Y,K,Tt),R.modelViewMatrix.multiplyMatrices(Q.matrixWorldInverse,R.matrixWorld),R.normalMatrix.getNormalMatrix(R.modelViewMatrix),K.onBeforeRender(L,z,Q,Y,R,Tt),K.transparent===!0&&K.side===$n&&K.forceSinglePass===!1?(K.side=li,K.needsUpdate=!0,L.renderBufferDirect(Q,z,Y,K,R,Tt),K.side=ar,K.needsUpdate=!0,L.renderBufferDirect(Q,z,Y,K,R,Tt),K.side=$n):L.renderBufferDirect(Q,z,Y,K,R,Tt),R.onAfterRender(L,z,Q,Y,K,Tt)}function pn(R){let z=0;for(let Q of R)Q.texture!==null&&z++;return z}function $i(R,z,Q){z.isScene!==!0&&(z=Mn);let Y=Ht.get(R),K=E.state.lights,Tt=E.state.shadowsArray,It=K.state.version,At=ot.getParameters(R,K.state,Tt,z,Q,E.state.lightProbeGridArray),Lt=ot.getProgramCacheKey(At),zt=Y.programs;Y.environment=R.isMeshStandardMaterial||R.isMeshLambertMaterial||R.isMeshPhongMaterial?z.environment:null,Y.fog=z.fog;let ee=R.isMeshStandardMaterial||R.isMeshLambertMaterial&&!R.envMap||R.isMeshPhongMaterial&&!R.envMap;Y.envMap=P.get(R.envMap||Y.environment,ee),Y.envMapRotation=Y.environment!==null&&R.envMap===null?z.environmentRotation:R.envMapRotation,zt===void 0&&(R.addEventListener("dispose",ae),zt=new Map,Y.programs=zt,Y.programVariants=new Map);let fe=zt.get(Lt);if(fe!==void 0){if(Y.currentProgram===fe&&Y.lightsStateVersion===It)return Ko(R,At),fe}else At.uniforms=ot.getUniforms(R),B!==null&&R.isNodeMaterial&&B.build(R,Q,At),R.onBeforeCompile(At,L),fe=ot.acquireProgram(At,Lt),zt.set(Lt,fe),Y.uniforms=At.uniforms;let Bt=Y.uniforms;return(!R.isShaderMaterial&&!R.isRawShaderMaterial||R.clipping===!0)&&(Bt.clippingPlanes=st.uniform),Ko(R,At),Y.needsLights=Is(R),Y.lightsStateVersion=It,Y.needsLights&&(Bt.ambientLightColor.value=K.state.ambient,Bt.lightProbe.value=K.state.probe,Bt.sunLights.value=K.state.sun,Bt.sunLightShadows.value=K.state.sunShadow,Bt.directionalLights.value=K.state.directional,Bt.directionalLightShadows.value=K.state.directionalShadow,Bt.spotLights.value=K.state.spot,Bt.spotLightShadows.value=K.state.spotShadow,Bt.rectAreaLights.value=K.state.rectArea,Bt.ltc_1.value=K.state.rectAreaLTC1,Bt.ltc_2.value=K.state.rectAreaLTC2,Bt.pointLights.value=K.state.point,Bt.pointLightShadows.value=K.state.pointShadow,Bt.hemisphereLights.value=K.state.hemi,Bt.sunShadowMatrix.value=K.state.sunShadowMatrix,Bt.sunShadowCascade.value=K.state.sunShadowCascade,Bt.directionalShadowMatrix.value=K.state.directionalShadowMatrix,Bt.spotLightMatrix.value=K.state.spotLightMatrix,Bt.spotLightMap.value=K.state.spotLightMap,Bt.pointShadowMatrix.value=K.state.pointShadowMatrix),Y.numLightProbeGrids=pn(E.state.lightProbeGridArray),Y.currentProgram=fe,Y.uniformsList=null,fe}function ui(R,z,Q,Y,K){let Tt=Ht.get(R),It=Tt.currentProgram.id+","+Y+","+K,At=Tt.programVariants.get(It);return At===void 0?(At=$i(R,z,Q),Tt.programVariants.set(It,At)):(Tt.currentProgram=At,Tt.uniformsList=null,Tt.outputColorSpace=Y,Tt.toneMapping=K),At}function Ps(R){if(R.uniformsList===null){let z=R.currentProgram.getUniforms();R.uniformsList=$o.seqWithValue(z.seq,R.uniforms)}return R.uniformsList}function Ko(R,z){let Q=Ht.get(R);Q.outputColorSpace=z.outputColorSpace,Q.batching=z.batching,Q.batchingColor=z.batchingColor,Q.instancing=z.instancing,Q.instancingColor=z.instancingColor,Q.instancingMorph=z.instancingMorph,Q.skinning=z.skinning,Q.morphTargets=z.morphTargets,Q.morphNormals=z.morphNormals,Q.morphColors=z.morphColors,Q.morphTargetsCount=z.morphTargetsCount,Q.numClippingPlanes=z.numClippingPlanes,Q.numIntersection=z.numClipIntersection,Q.vertexAlphas=z.vertexAlphas,Q.vertexTangents=z.vertexTangents,Q.toneMapping=z.toneMapping}function Jo(R,z,Q,Y,K){z.isScene!==!0&&(z=Mn),qt.resetTextureUnits();let Tt=z.fog,It=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial?z.environment:null,At=lt===null?L.outputColorSpace:lt.isXRRenderTarget===!0?lt.texture.colorSpace:xe.workingColorSpace,Lt=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial&&!Y.envMap||Y.isMeshPhongMaterial&&!Y.envMap,zt=P.get(Y.envMap||It,Lt),ee=Y.vertexColors===!0&&!!Q.attributes.color&&Q.attributes.color.itemSize===4,fe=!!Q.attributes.tangent&&(!!Y.normalMap||Y.anisotropy>0),Bt=!!Q.morphAttributes.position,pe=!!Q.morphAttributes.normal,tn=!!Q.morphAttributes.color,Le=es;Y.toneMapped&&(lt===null||lt.isXRRenderTarget===!0)&&(Le=L.toneMapping);let De=Q.morphAttributes.position||Q.morphAttributes.normal||Q.morphAttributes.color,En=De!==void 0?De.length:0,Ft=Ht.get(Y),_n=E.state.lights;if(We===!0&&(mn===!0||R!==j)){let Ne=R===j&&Y.id===Z;st.setState(Y,R,Ne)}let ye=!1,as=!1;Y.version===Ft.__version?Ft.needsLights&&Ft.lightsStateVersion!==_n.state.version||K.isBatchedMesh&&Ft.batching===!1||!K.isBatchedMesh&&Ft.batching===!0||K.isBatchedMesh&&Ft.batchingColor===!0&&K._colorsTexture===null||K.isBatchedMesh&&Ft.batchingColor===!1&&K._colorsTexture!==null||K.isInstancedMesh&&Ft.instancing===!1||!K.isInstancedMesh&&Ft.instancing===!0||K.isSkinnedMesh&&Ft.skinning===!1||!K.isSkinnedMesh&&Ft.skinning===!0||K.isInstancedMesh&&Ft.instancingColor===!0&&K.instanceColor===null||K.isInstancedMesh&&Ft.instancingColor===!1&&K.instanceColor!==null||K.isInstancedMesh&&Ft.instancingMorph===!0&&K.morphTexture===null||K.isInstancedMesh&&Ft.instancingMorph===!1&&K.morphTexture!==null||Ft.envMap!==zt||Y.fog===!0&&Ft.fog!==Tt||Ft.numClippingPlanes!==void 0&&(Ft.numClippingPlanes!==st.numPlanes||Ft.numIntersection!==st.numIntersection)||Ft.vertexAlphas!==ee||Ft.vertexTangents!==fe||Ft.morphTargets!==Bt||Ft.morphNormals!==pe||Ft.morphColors!==tn||Ft.morphTargetsCount!==En||Ft.numLightProbeGrids!==pn(E.state.lightProbeGridArray)?ye=!0:(Ft.outputColorSpace!==At||Ft.toneMapping!==Le)&&(as=!0):(ye=!0,Ft.__version=Y.version);let yn=Ft.currentProgram;(ye===!0||as===!0)&&(yn=as===!0?ui(Y,z,K,At,Le):$i(Y,z,K),B&&Y.isNodeMaterial&&B.onUpdateProgram(Y,yn,Ft));let Gr=!1,Xi=!1,ls=!1,ce=yn.getUniforms(),ln=Ft.uniforms;if(Mt.useProgram(yn.program)&&(Gr=!0,Xi=!0,ls=!0),Y.id!==Z&&(Z=Y.id,Xi=!0),Gr||j!==R){Mt.buffers.depth.getReversed()&&R.reversedDepth!==!0&&(R._reversedDepth=!0,R.updateProjectionMatrix()),ce.setValue(k,"projectionMatrix",R.projectionMatrix),ce.setValue(k,"viewMatrix",R.matrixWorldInverse);let vn=ce.map.cameraPosition;vn!==void 0&&vn.setValue(k,Dn.setFromMatrixPosition(R.matrixWorld)),oe.logarithmicDepthBuffer&&ce.setValue(k,"logDepthBufFC",2/(Math.log(R.far+1)/Math.LN2)),(Y.isMeshPhongMaterial||Y.isMeshToonMaterial||Y.isMeshLambertMaterial||Y.isMeshBasicMaterial||Y.isMeshStandardMaterial||Y.isShaderMaterial)&&ce.setValue(k,"isOrthographic",R.isOrthographicCamera===!0),j!==R&&(j=R,Xi=!0,ls=!0)}if(Ft.needsLights&&(_n.state.sunShadowMap.length>0&&ce.setValue(k,"sunShadowMap",_n.state.sunShadowMap,qt),_n.state.directionalShadowMap.length>0&&ce.setValue(k,"directionalShadowMap",_n.state.directionalShadowMap,qt),_n.state.spotShadowMap.length>0&&ce.setValue(k,"spotShadowMap",_n.state.spotShadowMap,qt),_n.state.pointShadowMap.length>0&&ce.setValue(k,"pointShadowMap",_n.state.pointShadowMap,qt)),K.isSkinnedMesh){ce.setOptional(k,K,"bindMatrix"),ce.setOptional(k,K,"bindMatrixInverse");let Ne=K.skeleton;Ne&&(Ne.boneTexture===null&&Ne.computeBoneTexture(),ce.setValue(k,"boneTexture",Ne.boneTexture,qt))}K.isBatchedMesh&&(ce.setOptional(k,K,"batchingTexture"),ce.setValue(k,"batchingTexture",K._matricesTexture,qt),ce.setOptional(k,K,"batchingIdTexture"),ce.setValue(k,"batchingIdTexture",K._indirectTexture,qt),ce.setOptional(k,K,"batchingColorTexture"),K._colorsTexture!==null&&ce.setValue(k,"batchingColorTexture",K._colorsTexture,qt));let ti=Q.morphAttributes;if((ti.position!==void 0||ti.normal!==void 0||ti.color!==void 0)&&rt.update(K,Q,yn),(Xi||Ft.receiveShadow!==K.receiveShadow)&&(Ft.receiveShadow=K.receiveShadow,ce.setValue(k,"receiveShadow",K.receiveShadow)),(Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial)&&Y.envMap===null&&z.environment!==null&&(ln.envMapIntensity.value=z.environmentIntensity),ln.dfgLUT!==void 0&&(ln.dfgLUT.value=MA()),Xi){if(ce.setValue(k,"toneMappingExposure",L.toneMappingExposure),Ft.needsLights&&zr(ln,ls),Tt&&Y.fog===!0&&yt.refreshFogUniforms(ln,Tt),yt.refreshMaterialUniforms(ln,Y,St,Rt,E.state.transmissionRenderTarget[R.id]),Ft.needsLights&&Ft.numLightProbeGrids>0){let Ne=y,vn=0;for(let Xn of E.state.lightProbeGridArray)Xn.texture!==null&&(Ne.textures[vn]=Xn.texture,Ne.min[vn]=Xn.boundingBox.min,Ne.max[vn]=Xn.boundingBox.max,Ne.resolution[vn]=Xn.resolution,vn++);for(let Xn in Ne)Ne[Xn].length=vn;ln.probesSH.value=Ne.textures,ln.probesMin.value=Ne.min,ln.probesMax.value=Ne.max,ln.probesResolution.value=Ne.resolution}$o.upload(k,Ps(Ft),ln,qt)}if(Y.isShaderMaterial&&Y.uniformsNeedUpdate===!0&&($o.upload(k,Ps(Ft),ln,qt),Y.uniformsNeedUpdate=!1),Y.isSpriteMaterial&&ce.setValue(k,"center",K.center),ce.setValue(k,"modelViewMatrix",K.modelViewMatrix),ce.setValue(k,"normalMatrix",K.normalMatrix),ce.setValue(k,"modelMatrix",K.matrixWorld),Y.uniformsGroups!==void 0){let Ne=Y.uniformsGroups;for(let vn=0,Xn=Ne.length;vn<Xn;vn++){let pl=Ne[vn];Wt.update(pl,yn),Wt.bind(pl,yn)}}return yn}function zr(R,z){R.ambientLightColor.needsUpdate=z,R.lightProbe.needsUpdate=z,R.sunLights.needsUpdate=z,R.sunLightShadows.needsUpdate=z,R.directionalLights.needsUpdate=z,R.directionalLightShadows.needsUpdate=z,R.pointLights.needsUpdate=z,R.pointLightShadows.needsUpdate=z,R.spotLights.needsUpdate=z,R.spotLightShadows.needsUpdate=z,R.rectAreaLights.needsUpdate=z,R.hemisphereLights.needsUpdate=z}function Is(R){return R.isMeshLambertMaterial||R.isMeshToonMaterial||R.isMeshPhongMaterial||R.isMeshStandardMaterial||R.isShadowMaterial||R.isShaderMaterial&&R.lights===!0}this.getActiveCubeFace=function(){return q},this.getActiveMipmapLevel=function(){return V},this.getRenderTarget=function(){return lt},this.setRenderTargetTextures=function(R,z,Q){let Y=Ht.get(R);Y.__autoAllocateDepthBuffer=R.resolveDepthBuffer===!1,Y.__autoAllocateDepthBuffer===!1&&(Y.__useRenderToTexture=!1),Ht.get(R.texture).__webglTexture=z,Ht.get(R.depthTexture).__webglTexture=Y.__autoAllocateDepthBuffer?void 0:Q,Y.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(R,z){let Q=Ht.get(R);Q.__webglFramebuffer=z,Q.__useDefaultFramebuffer=z===void 0},this.setRenderTarget=function(R,z=0,Q=0){lt=R,q=z,V=Q;let Y=null,K=!1,Tt=!1;if(R){let At=Ht.get(R);if(At.__useDefaultFramebuffer!==void 0){Mt.bindFramebuffer(k.FRAMEBUFFER,At.__webglFramebuffer),et.copy(R.viewport),dt.copy(R.scissor),ut=R.scissorTest,Mt.viewport(et),Mt.scissor(dt),Mt.setScissorTest(ut),Z=-1;return}else if(At.__webglFramebuffer===void 0)qt.setupRenderTarget(R);else if(At.__hasExternalTextures)qt.rebindTextures(R,Ht.get(R.texture).__webglTexture,Ht.get(R.depthTexture).__webglTexture);else if(R.depthBuffer){let ee=R.depthTexture;if(At.__boundDepthTexture!==ee){if(ee!==null&&Ht.has(ee)&&(R.width!==ee.image.width||R.height!==ee.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");qt.setupDepthRenderbuffer(R)}}let Lt=R.texture;(Lt.isData3DTexture||Lt.isDataArrayTexture||Lt.isCompressedArrayTexture)&&(Tt=!0);let zt=Ht.get(R).__webglFramebuffer;R.isWebGLCubeRenderTarget?(Array.isArray(zt[z])?Y=zt[z][Q]:Y=zt[z],K=!0):R.samples>0&&qt.useMultisampledRTT(R)===!1?Y=Ht.get(R).__webglMultisampledFramebuffer:Array.isArray(zt)?Y=zt[Q]:Y=zt,et.copy(R.viewport),dt.copy(R.scissor),ut=R.scissorTest}else et.copy(Gt).multiplyScalar(St).floor(),dt.copy(de).multiplyScalar(St).floor(),ut=le;if(Q!==0&&(Y=G),Mt.bindFramebuffer(k.FRAMEBUFFER,Y)&&Mt.drawBuffers(R,Y),Mt.viewport(et),Mt.scissor(dt),Mt.setScissorTest(ut),K){let At=Ht.get(R.texture);k.framebufferTexture2D(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_CUBE_MAP_POSITIVE_X+z,At.__webglTexture,Q)}else if(Tt){let At=z;for(let Lt=0;Lt<R.textures.length;Lt++){let zt=Ht.get(R.textures[Lt]);k.framebufferTextureLayer(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0+Lt,zt.__webglTexture,Q,At)}}else if(R!==null&&Q!==0){let At=Ht.get(R.texture);k.framebufferTexture2D(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,At.__webglTexture,Q)}Z=-1};function Hr(R){let z=Ht.get(R);return(z.__readFormat!==R.format||z.__readType!==R.type)&&(z.__readFormat=R.format,z.__readType=R.type,z.__formatReadable=oe.textureFormatReadable(R.format),z.__typeReadable=oe.textureTypeReadable(R.type)),z}this.readRenderTargetPixels=function(R,z,Q,Y,K,Tt,It,At=0){if(!(R&&R.isWebGLRenderTarget)){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Lt=Ht.get(R).__webglFramebuffer;if(R.isWebGLCubeRenderTarget&&It!==void 0&&(Lt=Lt[It],Array.isArray(Lt)&&(Lt=Lt[0])),Lt){Mt.bindFramebuffer(k.FRAMEBUFFER,Lt);try{let zt=R.textures[At],ee=zt.format,fe=zt.type;R.textures.length>1&&k.readBuffer(k.COLOR_ATTACHMENT0+At);let Bt=Hr(zt);if(Bt.__formatReadable===!1){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Bt.__typeReadable===!1){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}z>=0&&z<=R.width-Y&&Q>=0&&Q<=R.height-K&&k.readPixels(z,Q,Y,K,_t.convert(ee),_t.convert(fe),Tt)}finally{let zt=lt!==null?Ht.get(lt).__webglFramebuffer:null;Mt.bindFramebuffer(k.FRAMEBUFFER,zt)}}},this.readRenderTargetPixelsAsync=async function(R,z,Q,Y,K,Tt,It,At=0){if(!(R&&R.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Lt=Ht.get(R).__webglFramebuffer;if(R.isWebGLCubeRenderTarget&&It!==void 0&&(Lt=Lt[It],Array.isArray(Lt)&&(Lt=Lt[0])),Lt)if(z>=0&&z<=R.width-Y&&Q>=0&&Q<=R.height-K){Mt.bindFramebuffer(k.FRAMEBUFFER,Lt);let zt=R.textures[At],ee=zt.format,fe=zt.type;R.textures.length>1&&k.readBuffer(k.COLOR_ATTACHMENT0+At);let Bt=Hr(zt);if(Bt.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Bt.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let pe=k.createBuffer();k.bindBuffer(k.PIXEL_PACK_BUFFER,pe),k.bufferData(k.PIXEL_PACK_BUFFER,Tt.byteLength,k.STREAM_READ),k.readPixels(z,Q,Y,K,_t.convert(ee),_t.convert(fe),0),k.bindBuffer(k.PIXEL_PACK_BUFFER,null);let tn=lt!==null?Ht.get(lt).__webglFramebuffer:null;Mt.bindFramebuffer(k.FRAMEBUFFER,tn);let Le=k.fenceSync(k.SYNC_GPU_COMMANDS_COMPLETE,0);return k.flush(),await D_(k,Le,4),k.bindBuffer(k.PIXEL_PACK_BUFFER,pe),k.getBufferSubData(k.PIXEL_PACK_BUFFER,0,Tt),k.bindBuffer(k.PIXEL_PACK_BUFFER,null),k.deleteBuffer(pe),k.deleteSync(Le),Tt}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(R,z=null,Q=0){let Y=Math.pow(2,-Q),K=Math.floor(R.image.width*Y),Tt=Math.floor(R.image.height*Y),It=z!==null?z.x:0,At=z!==null?z.y:0;qt.setTexture2D(R,0),k.copyTexSubImage2D(k.TEXTURE_2D,Q,0,0,It,At,K,Tt),Mt.unbindTexture()},this.copyTextureToTexture=function(R,z,Q=null,Y=null,K=0,Tt=0){let It,At,Lt,zt,ee,fe,Bt,pe,tn,Le=R.isCompressedTexture?R.mipmaps[Tt]:R.image;if(Q!==null)It=Q.max.x-Q.min.x,At=Q.max.y-Q.min.y,Lt=Q.isBox3?Q.max.z-Q.min.z:1,zt=Q.min.x,ee=Q.min.y,fe=Q.isBox3?Q.min.z:0;else{let ce=Math.pow(2,-K);It=Math.floor(Le.width*ce),At=Math.floor(Le.height*ce),R.isDataArrayTexture?Lt=Le.depth:R.isData3DTexture?Lt=Math.floor(Le.depth*ce):Lt=1,zt=0,ee=0,fe=0}Y!==null?(Bt=Y.x,pe=Y.y,tn=Y.z):(Bt=0,pe=0,tn=0);let De=_t.convert(z.format),En=_t.convert(z.type),Ft;z.isData3DTexture?(qt.setTexture3D(z,0),Ft=k.TEXTURE_3D):z.isDataArrayTexture||z.isCompressedArrayTexture?(qt.setTexture2DArray(z,0),Ft=k.TEXTURE_2D_ARRAY):(qt.setTexture2D(z,0),Ft=k.TEXTURE_2D),Mt.activeTexture(k.TEXTURE0),Mt.pixelStorei(k.UNPACK_FLIP_Y_WEBGL,z.flipY),Mt.pixelStorei(k.UNPACK_PREMULTIPLY_ALPHA_WEBGL,z.premultiplyAlpha),Mt.pixelStorei(k.UNPACK_ALIGNMENT,z.unpackAlignment);let _n=Mt.getParameter(k.UNPACK_ROW_LENGTH),ye=Mt.getParameter(k.UNPACK_IMAGE_HEIGHT),as=Mt.getParameter(k.UNPACK_SKIP_PIXELS),yn=Mt.getParameter(k.UNPACK_SKIP_ROWS),Gr=Mt.getParameter(k.UNPACK_SKIP_IMAGES);Mt.pixelStorei(k.UNPACK_ROW_LENGTH,Le.width),Mt.pixelStorei(k.UNPACK_IMAGE_HEIGHT,Le.height),Mt.pixelStorei(k.UNPACK_SKIP_PIXELS,zt),Mt.pixelStorei(k.UNPACK_SKIP_ROWS,ee),Mt.pixelStorei(k.UNPACK_SKIP_IMAGES,fe);let Xi=R.isDataArrayTexture||R.isData3DTexture,ls=z.isDataArrayTexture||z.isData3DTexture;if(R.isDepthTexture){let ce=Ht.get(R),ln=Ht.get(z),ti=Ht.get(ce.__renderTarget),Ne=Ht.get(ln.__renderTarget);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,ti.__webglFramebuffer),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,Ne.__webglFramebuffer);for(let vn=0;vn<Lt;vn++)Xi&&(k.framebufferTextureLayer(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,Ht.get(R).__webglTexture,K,fe+vn),k.framebufferTextureLayer(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,Ht.get(z).__webglTexture,Tt,tn+vn)),k.blitFramebuffer(zt,ee,zt+It,ee+At,Bt,pe,Bt+It,pe+At,k.DEPTH_BUFFER_BIT,k.NEAREST);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,null)}else if(K!==0||R.isRenderTargetTexture||Ht.has(R)){let ce=Ht.get(R),ln=Ht.get(z);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,N),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,W);for(let ti=0;ti<Lt;ti++)Xi?k.framebufferTextureLayer(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,ce.__webglTexture,K,fe+ti):k.framebufferTexture2D(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,ce.__webglTexture,K),ls?k.framebufferTextureLayer(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,ln.__webglTexture,Tt,tn+ti):k.framebufferTexture2D(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,ln.__webglTexture,Tt),K!==0?k.blitFramebuffer(zt,ee,zt+It,ee+At,Bt,pe,Bt+It,pe+At,k.COLOR_BUFFER_BIT,k.NEAREST):ls?k.copyTexSubImage3D(Ft,Tt,Bt,pe,tn+ti,zt,ee,It,At):k.copyTexSubImage2D(Ft,Tt,Bt,pe,zt,ee,It,At);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,null)}else ls?R.isDataTexture||R.isData3DTexture?k.texSubImage3D(Ft,Tt,Bt,pe,tn,It,At,Lt,De,En,Le.data):z.isCompressedArrayTexture?k.compressedTexSubImage3D(Ft,Tt,Bt,pe,tn,It,At,Lt,De,Le.data):k.texSubImage3D(Ft,Tt,Bt,pe,tn,It,At,Lt,De,En,Le):R.isDataTexture?k.texSubImage2D(k.TEXTURE_2D,Tt,Bt,pe,It,At,De,En,Le.data):R.isCompressedTexture?k.compressedTexSubImage2D(k.TEXTURE_2D,Tt,Bt,pe,Le.width,Le.height,De,Le.data):k.texSubImage2D(k.TEXTURE_2D,Tt,Bt,pe,It,At,De,En,Le);Mt.pixelStorei(k.UNPACK_ROW_LENGTH,_n),Mt.pixelStorei(k.UNPACK_IMAGE_HEIGHT,ye),Mt.pixelStorei(k.UNPACK_SKIP_PIXELS,as),Mt.pixelStorei(k.UNPACK_SKIP_ROWS,yn),Mt.pixelStorei(k.UNPACK_SKIP_IMAGES,Gr),Tt===0&&z.generateMipmaps===!0&&z.mipmapsAutoUpdate===!0&&k.generateMipmap(Ft),Mt.unbindTexture()},this.initRenderTarget=function(R){Ht.get(R).__webglFramebuffer===void 0&&qt.setupRenderTarget(R)},this.initTexture=function(R){R.isCubeTexture?qt.setTextureCube(R,0):R.isData3DTexture?qt.setTexture3D(R,0):R.isDataArrayTexture||R.isCompressedArrayTexture?qt.setTexture2DArray(R,0):qt.setTexture2D(R,0),Mt.unbindTexture()},this.resetState=function(){q=0,V=0,lt=null,Mt.reset(),wt.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Ai}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorSpace=xe._getDrawingBufferColorSpace(t),e.unpackColorSpace=xe._getUnpackColorSpace()}};var EA=`
uniform highp sampler2D restMap;
uniform highp sampler2D boneMap;
uniform float vertices;
attribute float source;
attribute vec4 boneIndex;
attribute vec4 boneWeight;
attribute vec2 regionPart;
attribute float slot;
#ifdef CROWD_COLOR
uniform sampler2D colorMap;
varying vec3 vCloth;
varying vec4 vTint;
#endif
vec3 turnBy(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`,TA=`
int row = int(slot + 0.5);
vec4 who = texelFetch(boneMap, ivec2(56, row), 0);
int at = int(who.x * vertices + source + 0.5);
vec3 restPoint = texelFetch(restMap, ivec2(at & 2047, at >> 11), 0).xyz * who.y;
vec3 skinned = vec3(0.0);
vec3 bent = vec3(0.0);
for (int k = 0; k < 4; k++) {
  int bone = int(boneIndex[k] + 0.5);
  vec4 q = texelFetch(boneMap, ivec2(2 * bone, row), 0);
  vec3 shift = texelFetch(boneMap, ivec2(2 * bone + 1, row), 0).xyz;
  skinned += boneWeight[k] * (turnBy(q, restPoint) + shift);
  bent += boneWeight[k] * turnBy(q, normal);
}
bool worn = ((int(who.z + 0.5) >> int(regionPart.y + 0.5)) & 1) == 1;
`;function tp(i,t,e){return i.defines={...i.defines,...e?{CROWD_COLOR:1}:{}},i.onBeforeCompile=n=>{Object.assign(n.uniforms,t),n.vertexShader=n.vertexShader.replace("#include <common>",`#include <common>
${EA}`).replace("void main() {",`void main() {
${TA}`).replace("#include <beginnormal_vertex>","vec3 objectNormal = normalize(bent);").replace("#include <begin_vertex>",`vec3 transformed = worn ? skinned : vec3(0.0, 0.0, -1.0e4);
        #ifdef CROWD_COLOR
        vCloth = texelFetch(colorMap, ivec2(int(regionPart.x + 0.5), int(who.w + 0.5)), 0).rgb;
        vTint = texelFetch(boneMap, ivec2(57, row), 0);
        #endif`),e&&(n.fragmentShader=n.fragmentShader.replace("#include <common>",`#include <common>
varying vec3 vCloth;
varying vec4 vTint;`).replace("#include <color_fragment>","diffuseColor.rgb = mix(vCloth, vTint.rgb, vTint.a);"))},i.customProgramCacheKey=()=>`crowd${e?1:0}`,i}var np=3,ep=2048,sl=232,Sy=[190,64],My=[16,80],AA=1e-4,RA=[22,26],Qh=class{constructor(t){this.group=new un,this.counts=[0,0,0],this.capacity=0,this._boneMap={value:null},this._colorMap={value:null},this._levels=t.map(e=>this._level(e.arrays)),this._shade=IA(),this.group.add(this._shade),this.reserve(64)}dress(t,e){let n=Math.max(1,t.colors?.length??0),s=new Uint8Array(4*e*n);(t.colors??[]).forEach((o,a)=>{for(let l=0;l<e;l++){let c=4*(a*e+l);for(let h=0;h<3;h++)s[c+h]=parseInt(o.slice(6*l+2*h,6*l+2*h+2),16);s[c+3]=255}}),this._colorMap.value?.dispose();let r=new Ri(s,e,n,Cn);r.colorSpace=sn,r.needsUpdate=!0,this._colorMap.value=r}reserve(t){if(t<=this.capacity)return;for(;this.capacity<t;)this.capacity=Math.max(64,2*this.capacity);this._boneMap.value?.dispose(),this.bones=new Float32Array(sl*this.capacity);let e=new Ri(this.bones,sl/4,this.capacity,Cn,Jn);this._boneMap.value=e;for(let n of this._levels)n.geometry.setAttribute("slot",CA(this.capacity)),n.geometry._maxInstanceCount=void 0;this._shade.geometry.setAttribute("spot",new Ss(new Float32Array(4*this.capacity),4)),this._shade.geometry._maxInstanceCount=void 0}update(t,e,n,s){let r=t.people;this.reserve(r),this.shadeDepth=s,t.pose(this.bones,sl);let{who:o,ids:a}=t.frame.arrays,{body:l,scale:c,parts:h}=t.description.people;for(let d=0;d<r;d++){let u=d*sl+224;this.bones[u]=l[o[d]],this.bones[u+1]=c[o[d]],this.bones[u+2]=h[o[d]],this.bones[u+3]=o[d];let p=e.has(a[d])?.55:0;this.bones[u+4]=n.r,this.bones[u+5]=n.g,this.bones[u+6]=n.b,this.bones[u+7]=p}this._boneMap.value.needsUpdate=!0,this._state=t,this._raised=t.description.stage.ground.length>0}_ground(t){if(!this._raised)return 0;let e=this._state,{body:n,scale:s}=e.description.people,r=e.frame.arrays.who[t],o=1/0;for(let a of RA){let l=t*sl+8*a,c=3*(28*n[r]+a),[h,d,u]=e.heads.subarray(c,c+3),[p,m,x,g,,,_]=this.bones.subarray(l,l+7),b=s[r],S=2*(p*x-g*m)*h+2*(m*x+g*p)*d+(1-2*(p*p+m*m))*u;o=Math.min(o,_+b*(S-u))}return Math.max(0,o)}choose(t,e,n=null){this.counts=[0,0,0];let s=this._state;if(!s?.frame)return;let{pelvis:r,ids:o}=s.frame.arrays,a=e/(2*Math.tan(.5*Wo.degToRad(t.fov))),l=t.position,c=[];for(let d=0;d<s.people;d++){if(o[d]===n)continue;let u=Math.hypot(r[3*d]-l.x,r[3*d+1]-l.y,r[3*d+2]-l.z);c.push([u,d])}c.sort((d,u)=>d[0]-u[0]);let h=this._shade.geometry.attributes.spot;c.forEach(([d,u],p)=>{let m=1.7*a/Math.max(d,.1),x=m>Sy[0]&&p<My[0]?0:m>Sy[1]&&p<My[1]?1:2;this._levels[x].geometry.attributes.slot.array[this.counts[x]++]=u,h.array.set([r[3*u],r[3*u+1],this._ground(u),.42],4*p)}),this._levels.forEach((d,u)=>{d.geometry.instanceCount=this.counts[u],d.visible=this.counts[u]>0,d.geometry.attributes.slot.needsUpdate=!0}),this._shade.geometry.instanceCount=c.length,this._shade.material.uniforms.depth.value=this.shadeDepth,h.needsUpdate=!0}set shadows(t){for(let e of this._levels)e.castShadow=t;this._shade.visible=t}dispose(){for(let t of[...this._levels,this._shade])t.geometry.dispose(),t.material.dispose(),t.customDepthMaterial?.dispose();this._boneMap.value?.dispose(),this._colorMap.value?.dispose();for(let t of this._rests??[])t.dispose()}_level(t){let e=t.heads.length/84,n=t.rest.length/(3*e),s=new nr;s.setIndex(new Ue(t.faces,1)),s.setAttribute("position",new Ue(new Float32Array(t.normal.length),3)),s.setAttribute("normal",new Ue(t.normal,3)),s.setAttribute("source",new Ue(Float32Array.from(t.source),1)),s.setAttribute("boneIndex",new Ue(t.bones,4)),s.setAttribute("boneWeight",new Ue(t.weights,4,!0));let r=new Uint8Array(2*t.region.length);t.region.forEach((c,h)=>r.set([c,t.part[h]],2*h)),s.setAttribute("regionPart",new Ue(r,2));let o=PA(t.rest);(this._rests??=[]).push(o);let a={restMap:{value:o},boneMap:this._boneMap,colorMap:this._colorMap,vertices:{value:n}},l=new Ie(s,tp(new Kn({side:$n}),a,!0));return l.customDepthMaterial=tp(new js,a,!1),l.frustumCulled=!1,l.castShadow=!0,this.group.add(l),l}};function CA(i){let t=new Ss(new Float32Array(i),1);return t.setUsage(Ur),t}function PA(i){let t=i.length/3,e=Math.ceil(t/ep),n=new Float32Array(4*ep*e);for(let r=0;r<t;r++)for(let o=0;o<3;o++)n[4*r+o]=AA*i[3*r+o];let s=new Ri(n,ep,e,Cn,Jn);return s.needsUpdate=!0,s}function IA(){let i=new nr;i.setAttribute("position",new Ee([-1,-1,0,1,-1,0,1,1,0,-1,1,0],3)),i.setIndex([0,1,2,0,2,3]);let t=new Ci({transparent:!0,depthWrite:!1,polygonOffset:!0,polygonOffsetFactor:-4,uniforms:{depth:{value:.4}},vertexShader:`attribute vec4 spot; varying vec2 at;
      void main() { at = position.xy;
        gl_Position = projectionMatrix * viewMatrix * vec4(spot.xyz + vec3(position.xy * spot.w, 0.012), 1.0); }`,fragmentShader:`uniform float depth; varying vec2 at;
      void main() { float r = length(at); gl_FragColor = vec4(0.0, 0.0, 0.0, depth * pow(max(0.0, 1.0 - r), 1.6)); }`}),e=new Ie(i,t);return e.frustumCulled=!1,e.renderOrder=1,e}var LA=.004,Ey=14;function Ay(){return{scans:Ty("scan",5),clouds:Ty("cloud",2.5),ranges:NA(),forces:UA(),goals:FA(),paths:OA(),density:BA(),ttc:kA()}}function Ry(i=1){let t=new Fe,e=new Tr(t,new Hi({transparent:!0,opacity:.9,linewidth:i}));return e.frustumCulled=!1,e}function rl(i,t,e){let n=i.getAttribute("position");if(!n||n.array.length<e){let s=new Float32Array(Math.max(96,2*e));s.set(t.subarray?t.subarray(0,e):t),i.setAttribute("position",new Ue(s,3).setUsage(Ur))}else n.array.set(t.subarray?t.subarray(0,e):t),n.needsUpdate=!0;i.setDrawRange(0,e/3)}function Ty(i,t){let e=new Ca(new Fe,DA(t));return e.frustumCulled=!1,{object:e,update(n,s){let r=n.scans(i).map(c=>c.points),o=r.reduce((c,h)=>c+h.length,0),a=new Float32Array(o),l=0;for(let c of r)a.set(c,l),l+=c.length;e.material.color.set(s[i]),rl(e.geometry,a,o)}}}function DA(i){let t=new Uo({size:i,sizeAttenuation:!1,alphaTest:.5});return t.onBeforeCompile=e=>{e.fragmentShader=e.fragmentShader.replace("#include <alphatest_fragment>","if (length(gl_PointCoord - 0.5) > 0.5) discard;")},t}function NA(){let i=new Fe,t=new Ie(i,new Wn({transparent:!0,opacity:.22,depthWrite:!1,side:$n}));t.frustumCulled=!1;let e=new ai,n=new H;return{object:t,update(s,r){let o=s.frame.arrays.cones??new Float32Array(0),a=s.description.sensors.filter(c=>c.kind==="cone"),l=[];for(let c=0;c<o.length/9;c++){let[h,d,u,p,m,x,g,_]=o.subarray(9*c,9*c+9),b=a[c]?.angle??.2;e.set(m,x,g,p);let S=y=>{let C=2*Math.PI*y/Ey;return n.set(_*Math.cos(b),_*Math.sin(b)*Math.cos(C),_*Math.sin(b)*Math.sin(C)),n.applyQuaternion(e),[h+n.x,d+n.y,u+n.z]};for(let y=0;y<Ey;y++)l.push(h,d,u,...S(y),...S(y+1))}t.material.color.set(r.cone),rl(i,l,l.length)}}}function UA(){let i=new un,t=[];return{object:i,update(e,n){let s=e.frame.arrays.forces??new Float32Array(0),r=s.length/6;for(;t.length<r;){let o=new Wa(new H(1,0,0),new H,1,n.force);o.line.material.depthTest=o.cone.material.depthTest=!1,o.renderOrder=5,t.push(o),i.add(o)}t.forEach((o,a)=>{if(o.visible=a<r,!o.visible)return;let[l,c,h,d,u,p]=s.subarray(6*a,6*a+6),m=Math.hypot(d,u,p),x=Math.min(1.6,Math.max(.15,LA*m));o.position.set(l,c,h),m>1e-6&&o.setDirection(new H(d/m,u/m,p/m)),o.setLength(x,.25*x,.14*x),o.setColor(n.force)})}}}function FA(){let i=Ry();return{object:i,update(t,e){let{goals:n,place:s}=t.frame.arrays,r=[];for(let o=0;n&&o<t.people;o++){let[a,l]=[n[2*o],n[2*o+1]];Number.isFinite(a)&&Number.isFinite(l)&&r.push(s[5*o],s[5*o+1],.02,a,l,.02)}i.material.color.set(e.goal),i.material.opacity=.5,rl(i.geometry,r,r.length)}}}function OA(){let i=Ry();return{object:i,update(t,e){let n=[];Kl(t.frame,(s,r,o,a)=>n.push(s,r,.035,o,a,.035)),i.material.color.set(e.path),i.material.opacity=.75,rl(i.geometry,n,n.length)}}}function kA(){let i=new un,t=ps.map(({color:e})=>{let n=new Wn({color:e,transparent:!0,opacity:.9,depthWrite:!1,side:$n}),s=new Ie(new Fe,n);return s.frustumCulled=!1,i.add(s),s});return{object:i,update(e){let n=ps.map(()=>[]);Zl(e.frame,(s,r,o,a,l)=>{let c=Math.hypot(a-r,l-o)||1,h=.011*ps[s].width,[d,u]=[-h*(l-o)/c,h*(a-r)/c],p=(b,S)=>[b,S,.04],[m,x,g,_]=[p(r+d,o+u),p(r-d,o-u),p(a-d,l-u),p(a+d,l+u)];n[s].push(...m,...x,...g,...m,...g,..._)}),t.forEach((s,r)=>rl(s.geometry,n[r],n[r].length))}}}function BA(){let i=new Wn({transparent:!0,depthWrite:!1}),t=new Ie(new Es(1,1),i);return{object:t,update(e){let n=Yl(e.frame);if(t.scale.setScalar(n?1:0),!n)return;let{width:s,height:r,data:o,x:a,y:l,cell:c}=n,h=i.map?.image;(h?.width!==s||h?.height!==r)&&(i.map?.dispose(),i.map=new Ri(new Uint8Array(o.length),s,r,Cn),i.map.colorSpace=sn,i.map.magFilter=Vn,i.needsUpdate=!0),i.map.image.data.set(o),i.map.needsUpdate=!0,t.position.set(a+.5*s*c,l+.5*r*c,.02),t.scale.set(s*c,r*c,1)}}}function Py(i,t=!1){let e=i[0].index!==null,n=new Set(Object.keys(i[0].attributes)),s=new Set(Object.keys(i[0].morphAttributes)),r={},o={},a=i[0].morphTargetsRelative,l=new Fe;l.morphTargetsRelative=a;let c=0;for(let h=0;h<i.length;++h){let d=i[h],u=0,p=0;if(e!==(d.index!==null))return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+". All geometries must have compatible attributes; make sure index attribute exists among all geometries, or in none of them."),null;for(let m in d.attributes){if(!n.has(m))return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+'. All geometries must have compatible attributes; make sure "'+m+'" attribute exists among all geometries, or in none of them.'),null;r[m]===void 0&&(r[m]=[]),r[m].push(d.attributes[m]),u++}if(u!==n.size)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+". Make sure all geometries have the same number of attributes."),null;if(a!==d.morphTargetsRelative)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+". .morphTargetsRelative must be consistent throughout all geometries."),null;for(let m in d.morphAttributes){if(!s.has(m))return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+".  .morphAttributes must be consistent throughout all geometries."),null;if(d.morphAttributes[m].length!==i[0].morphAttributes[m].length)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+'. All geometries must have the same number of morph targets for the "'+m+'" morph attribute.'),null;o[m]===void 0&&(o[m]=[]),o[m].push(d.morphAttributes[m]),p++}if(p!==s.size)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+". Make sure all geometries have the same number of morph attributes."),null;if(t){let m;if(e)m=d.index.count;else if(d.attributes.position!==void 0)m=d.attributes.position.count;else return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed with geometry at index "+h+". The geometry must have either an index or a position attribute"),null;l.addGroup(c,m,h),c+=m}}if(e){let h=0,d=[];for(let u=0;u<i.length;++u){let p=i[u].index;for(let m=0;m<p.count;++m)d.push(p.getX(m)+h);h+=i[u].attributes.position.count}l.setIndex(d)}for(let h in r){let d=Cy(r[h]);if(!d)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed while trying to merge the "+h+" attribute."),null;l.setAttribute(h,d)}for(let h in o){let d=o[h][0].length;if(d!==0){l.morphAttributes=l.morphAttributes||{},l.morphAttributes[h]=[];for(let u=0;u<d;++u){let p=[];for(let x=0;x<o[h].length;++x)p.push(o[h][x][u]);let m=Cy(p);if(!m)return console.error("THREE.BufferGeometryUtils: .mergeGeometries() failed while trying to merge the "+h+" morphAttribute."),null;l.morphAttributes[h].push(m)}}}return l}function Cy(i){let t,e,n,s=-1,r=0;for(let c=0;c<i.length;++c){let h=i[c];if(t===void 0&&(t=h.array.constructor),t!==h.array.constructor)return console.error("THREE.BufferGeometryUtils: .mergeAttributes() failed. BufferAttribute.array must be of consistent array types across matching attributes."),null;if(e===void 0&&(e=h.itemSize),e!==h.itemSize)return console.error("THREE.BufferGeometryUtils: .mergeAttributes() failed. BufferAttribute.itemSize must be consistent across matching attributes."),null;if(n===void 0&&(n=h.normalized),n!==h.normalized)return console.error("THREE.BufferGeometryUtils: .mergeAttributes() failed. BufferAttribute.normalized must be consistent across matching attributes."),null;if(s===-1&&(s=h.gpuType),s!==h.gpuType)return console.error("THREE.BufferGeometryUtils: .mergeAttributes() failed. BufferAttribute.gpuType must be consistent across matching attributes."),null;r+=h.count*e}let o=new t(r),a=new Ue(o,e,n),l=0;for(let c=0;c<i.length;++c){let h=i[c];if(h.isInterleavedBufferAttribute){let d=l/e;for(let u=0,p=h.count;u<p;u++)for(let m=0;m<e;m++){let x=h.getComponent(u,m);a.setComponent(u+d,m,x)}}else o.set(h.array,l);l+=h.count*e}return s!==void 0&&(a.gpuType=s),a}function Iy(i,t=Math.PI/3){let e=i.index?i.toNonIndexed():i,n=e.attributes.position,s=n.count,r;if(n.isBufferAttribute===!0&&n.itemSize===3&&n.normalized===!1)r=n.array;else{r=new Float64Array(s*3);for(let y=0;y<s;y++)r[3*y+0]=n.getX(y),r[3*y+1]=n.getY(y),r[3*y+2]=n.getZ(y)}let o=Math.cos(t),a=(1+1e-10)*100,l=s/3,c=new Float64Array(l*3);for(let y=0;y<l;y++){let C=9*y,E=r[C+0],v=r[C+1],T=r[C+2],F=r[C+3],L=r[C+4],D=r[C+5],B=r[C+6],G=r[C+7],N=r[C+8],W=B-F,q=G-L,V=N-D,lt=E-F,Z=v-L,j=T-D,et=q*j-V*Z,dt=V*lt-W*j,ut=W*Z-q*lt,tt=1/(Math.sqrt(et*et+dt*dt+ut*ut)||1);c[3*y+0]=et*tt,c[3*y+1]=dt*tt,c[3*y+2]=ut*tt}let h=new Int32Array(s),d=new Float64Array(s*3),u=1;for(;u<s*2;)u<<=1;let p=u-1,m=new Int32Array(u),x=0;for(let y=0;y<s;y++){let C=3*y,E=Math.trunc(r[C+0]*a),v=Math.trunc(r[C+1]*a),T=Math.trunc(r[C+2]*a),F=(Math.imul(E,73856093)^Math.imul(v,19349663)^Math.imul(T,83492791))&p;for(;;){let L=m[F];if(L===0){let B=3*x;d[B+0]=E,d[B+1]=v,d[B+2]=T,m[F]=x+1,h[y]=x++;break}let D=3*(L-1);if(d[D+0]===E&&d[D+1]===v&&d[D+2]===T){h[y]=L-1;break}F=F+1&p}}let g=new Int32Array(x+1);for(let y=0;y<s;y++)g[h[y]+1]++;for(let y=0;y<x;y++)g[y+1]+=g[y];let _=new Int32Array(s),b=g.slice(0,x);for(let y=0;y<l;y++){let C=3*y;_[b[h[C+0]]++]=y,_[b[h[C+1]]++]=y,_[b[h[C+2]]++]=y}let S=new Float32Array(s*3);for(let y=0;y<l;y++){let C=3*y,E=c[C+0],v=c[C+1],T=c[C+2];for(let F=0;F<3;F++){let L=C+F,D=h[L],B=0,G=0,N=0;for(let q=g[D],V=g[D+1];q<V;q++){let lt=3*_[q],Z=c[lt+0],j=c[lt+1],et=c[lt+2];E*Z+v*j+T*et>o&&(B+=Z,G+=j,N+=et)}let W=1/(Math.sqrt(B*B+G*G+N*N)||1);S[3*L+0]=B*W,S[3*L+1]=G*W,S[3*L+2]=N*W}}return e.setAttribute("normal",new Ue(S,3,!1)),e}var zA=`
uniform highp sampler2D poseMap;
attribute float link;
attribute float slot;
vec3 turnBy(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`,HA=`
ivec2 place = ivec2(2 * int(link + 0.5), int(slot + 0.5));
vec3 linkPlace = texelFetch(poseMap, place, 0).xyz;
vec4 linkTurn = texelFetch(poseMap, place + ivec2(1, 0), 0);
`;function ip(i,t){return i.onBeforeCompile=e=>{e.uniforms.poseMap={value:t},e.vertexShader=e.vertexShader.replace("#include <common>",`#include <common>
${zA}`).replace("void main() {",`void main() {
${HA}`).replace("#include <beginnormal_vertex>","vec3 objectNormal = turnBy(linkTurn, normal);").replace("#include <begin_vertex>","vec3 transformed = turnBy(linkTurn, position) + linkPlace;")},i.customProgramCacheKey=()=>"robot",i}var GA=4096;async function Ly({arrays:i}){let t=[];for(let e=0;i[`image${e}`];e++)t.push(VA(i[`image${e}`]));return Promise.all(t)}async function VA(i){let t;try{t=await createImageBitmap(new Blob([i],{type:"image/png"}))}catch{return null}if(Math.max(t.width,t.height)>GA)return null;let e=new Zn(t);return e.colorSpace=sn,e.wrapS=e.wrapT=Ao,e.flipY=!1,e.anisotropy=4,e.needsUpdate=!0,e}function Dy({faces:i,textured:t}){let e=new Int32Array(i.length/3).fill(-1);for(let n=0;t&&n<t.length;n+=3)e.fill(t[n+2],t[n],t[n+1]);return e}var WA=.6,Ny=8,tu=class{constructor(){this.group=new un,this._robots=[],this._kinds=[],this._parts=new Map}build(t,e){this._clear();let n=new Map;this._robots=t.map(s=>{let r=`${s.ghost} ${s.key}`;n.has(r)||n.set(r,{robots:[],key:s.key,ghost:s.ghost});let o=n.get(r),a=s.type==="cylinder"?XA(s):null;return a&&this.group.add(a),{id:s.id,kind:o,slot:o.robots.push(s)-1,arrow:a}}),this._kinds=[...n.values()];for(let s of this._kinds){let{parts:r,links:o}=this._mesh(s.key,e.get(s.key));s.links=o,s.poses=new Ri(new Float32Array(Ny*Math.max(1,o)*s.robots.length),2*Math.max(1,o),s.robots.length,Cn,Jn),s.meshes=r.map(a=>$A(a,s)),s.meshes.length&&this.group.add(...s.meshes)}}update(t,e=null){let{bots:n,botplace:s,links:r}=t.frame.arrays,o=new Map(this._kinds.map(l=>[l,[]]));for(let{arrow:l}of this._robots)l&&(l.visible=!1);let a=0;n.forEach((l,c)=>{let{id:h,kind:d,slot:u,arrow:p}=this._robots[l];p&&(p.position.set(s[5*c],s[5*c+1],p.position.z),p.rotation.z=s[5*c+2],p.visible=h!==e),h!==e&&o.get(d).push(u);for(let m=0;m<d.links;m++,a+=7){let[x,g,_,b,S,y,C]=r.subarray(a,a+7),E=Math.hypot(b,S,y,C)||1;d.poses.image.data.set([x,g,_,0,S/E,y/E,C/E,b/E],Ny*(u*d.links+m))}});for(let[l,c]of o){l.poses.needsUpdate=!0;for(let h of l.meshes)h.geometry.attributes.slot.array.set(c),h.geometry.attributes.slot.needsUpdate=!0,h.geometry.instanceCount=c.length,h.visible=c.length>0}}set shadows(t){for(let{meshes:e,ghost:n}of this._kinds)for(let s of e)s.castShadow=t&&!n}dispose(){this._clear();for(let{parts:t}of this._parts.values())for(let{geometry:e,texture:n}of t)e.dispose(),n?.dispose()}_clear(){for(let{arrow:t}of this._robots)t?.geometry.dispose(),t?.material.dispose();for(let{meshes:t,poses:e}of this._kinds){e.dispose();for(let n of t)for(let s of[n.geometry,n.material,n.customDepthMaterial])s.dispose()}this._robots=this._kinds=[],this.group.clear()}_mesh(t,e){return this._parts.has(t)||this._parts.set(t,qA(e)),this._parts.get(t)}};function $A({geometry:i,texture:t},{ghost:e,robots:n,poses:s}){let r=new nr;for(let[c,h]of Object.entries(i.attributes))r.setAttribute(c,h);let o=new Ss(new Float32Array(n.length),1);r.setAttribute("slot",o.setUsage(Ur)),r.instanceCount=0;let a=e?{roughness:.6,transparent:!0,opacity:.45}:{roughness:.62,metalness:.05},l=new Ie(r,ip(new Cr({vertexColors:!0,map:t,...a}),s));return l.customDepthMaterial=ip(new js,s),l.frustumCulled=!1,l.castShadow=!e,l.receiveShadow=!0,l}function XA({radius:i,height:t}){let e=.6*i,n=new Fe,s=[e,0,0,-.5*e,.7*e,0,-.5*e,-.7*e,0];n.setAttribute("position",new Ee(s,3));let r=new Ie(n,new Wn({color:"#e66a1f"}));return r.position.z=t+.006,r}function qA({arrays:i,textures:t}){let{faces:e,first:n}=i,s=Dy(i),r=new Map;return n.forEach((a,l)=>{let c=l+1<n.length?n[l+1]:e.length/3,h=new Map;for(let d=a;d<c;d++){let u=t[s[d]]?s[d]:-1;h.has(u)||h.set(u,[]),h.get(u).push(d)}for(let[d,u]of h)r.set(d,[...r.get(d)??[],YA(i,u,d>=0,l)])}),{parts:[...r].map(([a,l])=>{let c=Py(l);for(let h of l)h.dispose();return{geometry:c,texture:t[a]??null}}),links:n.length}}function YA(i,t,e,n){let s=ZA(i,t,e),r=s.attributes.position.count;return s.setAttribute("link",new Ue(new Float32Array(r).fill(n),1))}function ZA({vertices:i,faces:t,color:e,uv:n},s,r){let o=new Float32Array(9*s.length),a=new Float32Array(9*s.length),l=r?new Float32Array(6*s.length):null,c=new Zt;s.forEach((d,u)=>{c.setRGB(e[4*d]/255,e[4*d+1]/255,e[4*d+2]/255,sn);for(let p=0;p<3;p++){let m=t[3*d+p];o.set(i.subarray(3*m,3*m+3),9*u+3*p),a.set([c.r,c.g,c.b],9*u+3*p),l&&l.set([n[2*m],1-n[2*m+1]],6*u+2*p)}});let h=new Fe;return h.setAttribute("position",new Ue(o,3)),h.setAttribute("color",new Ue(a,3)),l&&h.setAttribute("uv",new Ue(l,2)),Iy(h,WA)}var hr=.05;function Uy(i,t){let e=KA[i.kind];if(!e)return null;let n=e(i,t);return n.position.set(i.x,i.y,0),n.rotation.z=i.heading,n.userData.rise=i.kind==="cube"?.5*i.size:0,n}function Fy(i,t){let e=eu(i.width,.04,i.height,new Cr({color:t.door,transparent:!0,opacity:.55,roughness:.25}));e.position.set(.5*i.width,0,.5*i.height);let n=new un;return n.add(e),n.position.set(i.x,i.y,0),n.rotation.z=i.yaw,n}var KA={cube({size:i,color:t}){let e=new un,n=eu(i,i,i,new Kn({color:new Zt().setRGB(...t,sn)}));return n.position.z=.5*i,e.add(n),e},table({length:i,width:t,height:e},n){let s=new Kn({color:n.prop}),r=new un,o=eu(i,t,hr,s);o.position.z=e-.5*hr,r.add(o);for(let a of[-1,1])for(let l of[-1,1]){let c=eu(hr,hr,e-hr,s);c.position.set(.5*a*(i-hr),.5*l*(t-hr),.5*(e-hr)),r.add(c)}return r},tree({height:i,trunk:t,crown:e}){let n=new un,s=Math.max(.3*i,i-1.6*e),r=.5*(i-s)+.2*e,o=sp(new Js(.8*t,t,s,12).rotateX(Math.PI/2),new Kn({color:"#73543a"}));o.position.z=.5*s;let a=sp(new Fa(1,3),new Kn({color:"#5f8f4c"}));return a.scale.set(e,e,r),a.position.z=i-r,n.add(o,a),n}};function eu(i,t,e,n){return sp(new Ks(i,t,e),n)}function sp(i,t){let e=new Ie(i,t);return e.castShadow=e.receiveShadow=e.userData.casts=!0,e}var JA=1.1,Oy=.06,nu=class{constructor(){this.group=new un,this.parts={};for(let t of["floor","walls","props","zones"])this.parts[t]=new un,this.group.add(this.parts[t]);this._doors=[],this._props=new Map,this._height=2.5,this._full=!1}build(t,e){this._clear();let{stage:n,zones:s,bounds:r}=t;this._floor(r,e),this._walls(n,e),this._height=n.height,this.full=this._full;for(let o of n.ground)this.parts.floor.add(tR(o,e));this._doors=n.doors.map(o=>{let a=Fy(o,e);return this.parts.props.add(a),{door:o,mesh:a}}),n.props.forEach((o,a)=>{let l=Uy(o,e);l&&(this.parts.props.add(l),this._props.set(a,l))});for(let o of s)this.parts.zones.add(...eR(o,e));for(let o of t.robots)o.ghost||this.parts.zones.add(...nR(o,e))}set full(t){this._full=t,this.parts.walls.scale.z=t?1:Math.min(1,JA/this._height)}update(t){t.doors&&this._doors.forEach(({door:e,mesh:n},s)=>iR(e,n,t.doors[s])),t.props&&t.propnum.forEach((e,n)=>{let s=this._props.get(e);if(!s)return;let[r,o,a,l,c,h,d]=t.props.subarray(7*n,7*n+7);s.position.set(r,o,a-s.userData.rise),s.quaternion.set(c,h,d,l);let u=new H(0,0,-s.userData.rise).applyQuaternion(s.quaternion);s.position.set(r+u.x,o+u.y,a+u.z)})}set grid(t){this._grid&&(this._grid.shown.value=t?1:0)}set shadows(t){this.group.traverse(e=>{e.userData.casts&&(e.castShadow=t)})}dispose(){this._clear()}_clear(){for(let t of Object.values(this.parts))t.traverse(e=>{e.geometry?.dispose(),e.material?.map?.dispose(),e.material?.dispose()}),t.clear();this._doors=[],this._props.clear()}_floor([t,e,n,s],r){let o=120+2*Math.max(n-t,s-e);this._grid=QA(r);let a=new Ie(new Es(o,o),this._grid.material);a.position.set(.5*(t+n),.5*(e+s),0),a.receiveShadow=!0,this.parts.floor.add(a)}_walls({walls:t,height:e},n){let s=[],r=[],o=[];for(let l of t){let c=l.solid?l.points:jA(l.points),h=c.length;for(let d=0;d<h;d++){let[u,p]=[c[d],c[(d+1)%h]];s.push(u[0],u[1],0,p[0],p[1],0,p[0],p[1],e,u[0],u[1],0,p[0],p[1],e,u[0],u[1],e),o.push(u[0],u[1],e,p[0],p[1],e),l.inner&&o.push(u[0],u[1],.01,p[0],p[1],.01)}l.inner||r.push(...ky(c,e))}if(!s.length)return;this.parts.walls.add(ol(s,new Kn({color:n.wall}),!0)),r.length&&this.parts.walls.add(ol(r,new Kn({color:n.wallTop}),!1));let a=new Fe;a.setAttribute("position",new Ee(o,3)),this.parts.walls.add(new Tr(a,new Hi({color:n.wallTop})))}};function ky(i,t){let e=i.map(([n,s])=>new Vt(n,s));return Oo.isClockWise(e)&&e.reverse(),Oo.triangulateShape(e,[]).flatMap(n=>n.flatMap(s=>[e[s].x,e[s].y,t]))}function ol(i,t,e){let n=new Fe;n.setAttribute("position",new Ee(i,3)),n.computeVertexNormals();let s=new Ie(n,t);return s.castShadow=s.userData.casts=e,s.receiveShadow=!0,s}function jA([[i,t],[e,n]]){let s=Math.hypot(e-i,n-t)||1,[r,o]=[-.5*Oy*(n-t)/s,.5*Oy*(e-i)/s];return[[i-r,t-o],[e-r,n-o],[e+r,n+o],[i+r,t+o]]}function QA(i){let t=new Kn({color:i.floor,polygonOffset:!0,polygonOffsetFactor:2,polygonOffsetUnits:8}),e={value:1};return t.onBeforeCompile=n=>{Object.assign(n.uniforms,{gridShown:e,gridLine:{value:new Zt(i.line)},gridLine10:{value:new Zt(i.line10)}}),n.vertexShader=n.vertexShader.replace("#include <common>",`#include <common>
varying vec2 vPlace;`).replace("#include <begin_vertex>",`#include <begin_vertex>
vPlace = (modelMatrix * vec4(position, 1.0)).xy;`),n.fragmentShader=n.fragmentShader.replace("#include <common>",`#include <common>
        varying vec2 vPlace;
        uniform float gridShown;
        uniform vec3 gridLine, gridLine10;
        float gridAt(float step, float width) {
          vec2 at = vPlace / step;
          vec2 slope = fwidth(at);
          vec2 near = abs(fract(at - 0.5) - 0.5) / max(slope, vec2(1e-6));
          vec2 line = clamp(width - near, 0.0, 1.0) * clamp(0.45 / max(slope, vec2(1e-6)) - 0.8, 0.0, 1.0);
          return max(line.x, line.y);
        }`).replace("#include <color_fragment>",`#include <color_fragment>
        diffuseColor.rgb = mix(diffuseColor.rgb, gridLine, gridShown * gridAt(1.0, 1.0));
        diffuseColor.rgb = mix(diffuseColor.rgb, gridLine10, gridShown * gridAt(10.0, 1.4));`)},{material:t,shown:e}}function tR({corners:i,heights:t},e){let n=i.map(([r,o],a)=>[r,o,t[a]]),s=[...n[0],...n[1],...n[2],...n[0],...n[2],...n[3]];for(let r=0;r<4;r++){let[o,a]=[n[r],n[(r+1)%4]];s.push(o[0],o[1],0,a[0],a[1],0,...a,o[0],o[1],0,...a,...o)}return ol(s,new Kn({color:e.ground}),!0)}function eR(i,t){let e=t[i.kind],n=ol(ky(i.points,.006),new Wn({color:e,transparent:!0,opacity:i.kind==="start"?.05:.14,depthWrite:!1}),!1);n.receiveShadow=!1;let s=new Fe().setFromPoints(i.points.map(([o,a])=>new H(o,a,.012))),r=new Ra(s,i.kind==="goal"||i.kind==="exit"?new Oa({color:e,dashSize:.25,gapSize:.15}):new Hi({color:e}));return r.computeLineDistances(),[n,r]}function nR({goal:i},t){let e=new Ie(new Rr(Math.max(.05,i.tolerance-.05),i.tolerance,48),new Wn({color:t.robotGoal,transparent:!0,opacity:.9}));e.position.set(i.x,i.y,.014);let n=new Ie(new Js(.018,.018,1.5,10).rotateX(Math.PI/2),new Kn({color:t.ink}));n.position.set(i.x,i.y,.75);let s=ol([0,0,1.5,0,0,1.15,.5,0,1.32],new Wn({color:t.robotGoal,side:$n}),!0);return s.position.set(i.x,i.y,0),[e,n,s]}function iR(i,t,e){i.kind==="sliding"?t.position.set(i.x-e*i.width*Math.cos(i.yaw),i.y-e*i.width*Math.sin(i.yaw),0):t.rotation.z=i.yaw+e*i.angle}var By={type:"change"},op={type:"start"},Hy={type:"end"},iu=new ws,zy=new Gn,sR=Math.cos(70*Wo.DEG2RAD),Ln=new H,hi=2*Math.PI,Re={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},rp=1e-6,su=class extends $a{constructor(t,e=null){super(t,e),this.state=Re.NONE,this.target=new H,this.cursor=new H,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:rr.ROTATE,MIDDLE:rr.DOLLY,RIGHT:rr.PAN},this.touches={ONE:or.ROTATE,TWO:or.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new H,this._lastQuaternion=new ai,this._lastTargetPosition=new H,this._quat=new ai().setFromUnitVectors(t.up,new H(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new sr,this._sphericalDelta=new sr,this._scale=1,this._panOffset=new H,this._rotateStart=new Vt,this._rotateEnd=new Vt,this._rotateDelta=new Vt,this._panStart=new Vt,this._panEnd=new Vt,this._panDelta=new Vt,this._dollyStart=new Vt,this._dollyEnd=new Vt,this._dollyDelta=new Vt,this._dollyDirection=new H,this._mouse=new Vt,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=oR.bind(this),this._onPointerDown=rR.bind(this),this._onPointerUp=aR.bind(this),this._onContextMenu=pR.bind(this),this._onMouseWheel=hR.bind(this),this._onKeyDown=uR.bind(this),this._onTouchStart=dR.bind(this),this._onTouchMove=fR.bind(this),this._onMouseDown=lR.bind(this),this._onMouseMove=cR.bind(this),this._interceptControlDown=mR.bind(this),this._interceptControlUp=gR.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(t){this._cursorStyle=t,t==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(t){super.connect(t),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=Re.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(By),this.update(),this.state=Re.NONE}pan(t,e){this._pan(t,e),this.update()}dollyIn(t){this._dollyIn(t),this.update()}dollyOut(t){this._dollyOut(t),this.update()}rotateLeft(t){this._rotateLeft(t),this.update()}rotateUp(t){this._rotateUp(t),this.update()}update(t=null){let e=this.object.position;Ln.copy(e).sub(this.target),Ln.applyQuaternion(this._quat),this._spherical.setFromVector3(Ln),this.autoRotate&&this.state===Re.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=hi:n>Math.PI&&(n-=hi),s<-Math.PI?s+=hi:s>Math.PI&&(s-=hi),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(Ln.setFromSpherical(this._spherical),Ln.applyQuaternion(this._quatInverse),e.copy(this.target).add(Ln),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=Ln.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new H(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new H(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=Ln.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(iu.origin.copy(this.object.position),iu.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(iu.direction))<sR?this.object.lookAt(this.target):(zy.setFromNormalAndCoplanarPoint(this.object.up,this.target),iu.intersectPlane(zy,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>rp||8*(1-this._lastQuaternion.dot(this.object.quaternion))>rp||this._lastTargetPosition.distanceToSquared(this.target)>rp?(this.dispatchEvent(By),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?hi/60*this.autoRotateSpeed*t:hi/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){Ln.setFromMatrixColumn(e,0),Ln.multiplyScalar(-t),this._panOffset.add(Ln)}_panUp(t,e){this.screenSpacePanning===!0?Ln.setFromMatrixColumn(e,1):(Ln.setFromMatrixColumn(e,0),Ln.crossVectors(this.object.up,Ln)),Ln.multiplyScalar(t),this._panOffset.add(Ln)}_pan(t,e){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;Ln.copy(s).sub(this.target);let r=Ln.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/n.clientHeight,this.object.matrix),this._panUp(2*e*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=t-n.left,r=e-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientY),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(hi*this._rotateDelta.x/e.clientHeight),this._rotateUp(hi*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(hi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(-hi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(hi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(-hi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(n,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let n=this._getSecondPointerPosition(t),s=.5*(t.pageX+n.x),r=.5*(t.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(hi*this._rotateDelta.x/e.clientHeight),this._rotateUp(hi*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new Vt,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,n={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function rR(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function oR(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function aR(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(Hy),this.state=Re.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function lR(i){let t;switch(i.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case rr.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=Re.DOLLY;break;case rr.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Re.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Re.ROTATE}break;case rr.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Re.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Re.PAN}break;default:this.state=Re.NONE}this.state!==Re.NONE&&this.dispatchEvent(op)}function cR(i){switch(this.state){case Re.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case Re.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case Re.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function hR(i){this.enabled===!1||this.enableZoom===!1||this.state!==Re.NONE||(i.preventDefault(),this.dispatchEvent(op),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(Hy))}function uR(i){this.enabled!==!1&&this._handleKeyDown(i)}function dR(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case or.ROTATE:if(this.enableRotate===!1){this.state=Re.NONE;break}this._handleTouchStartRotate(i),this.state=Re.TOUCH_ROTATE;break;case or.PAN:if(this.enablePan===!1){this.state=Re.NONE;break}this._handleTouchStartPan(i),this.state=Re.TOUCH_PAN;break;default:this.state=Re.NONE}break;case 2:switch(this.touches.TWO){case or.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=Re.TOUCH_DOLLY_PAN;break;case or.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=Re.TOUCH_DOLLY_ROTATE;break;default:this.state=Re.NONE}break;default:this.state=Re.NONE}this.state!==Re.NONE&&this.dispatchEvent(op)}function fR(i){switch(this._trackPointer(i),this.state){case Re.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case Re.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case Re.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case Re.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=Re.NONE}}function pR(i){this.enabled!==!1&&i.preventDefault()}function mR(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function gR(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var Gy=45,_R=75,yR=15,vR=13,xR=.93,bR=.12,Vy=2.2,Wy=.005,ru=class{constructor(t){this.camera=new oi(Gy,1,.1,500),this.camera.up.set(0,0,1),this.controls=new su(this.camera,t),this.controls.maxPolarAngle=.495*Math.PI,this.controls.minDistance=.6,this.controls.maxDistance=250,this.controls.zoomToCursor=!0,this.name="free",this._target=null,this._last=null,this._gaze=[0,0],t.addEventListener("keydown",e=>this._key(e)),t.addEventListener("pointermove",e=>{this.firstPerson&&e.buttons&1&&this._turnHead(-Wy*e.movementX,-Wy*e.movementY)})}get firstPerson(){return this.name==="eyes"||this.name.startsWith("robot:")}list(t){return[{name:"free",title:"Free"},{name:"overview",title:"Overview"},{name:"beside",title:"Beside"},{name:"follow",title:"Follow"},{name:"eyes",title:"Through the eyes"},...t.robots.map(e=>({name:`robot:${e.name}`,title:`From ${e.name}`}))]}choose(t,e,n){this.name=t,this._target=n??this._target,this.controls.enabled=!this.firstPerson,this.camera.fov=this.firstPerson?_R:Gy,this._gaze=[0,0],this.camera.updateProjectionMatrix(),t==="overview"&&this.overview(e,!0),t==="follow"&&(this._start=!0),this._last=null}set target(t){this._target=t}followed(t){if(this._target&&t.place(this._target.kind,this._target.id))return this._target;let{bots:e,ids:n}=t.frame.arrays;return e.length?{kind:"robot",id:t.description.robots[e[0]].id}:n.length?{kind:"person",id:n[0]}:null}head(t){if(this.name==="eyes")return t.frame?this.followed(t):null;let e=t.description?.robots.find(n=>`robot:${n.name}`===this.name);return e?{kind:"robot",id:e.id}:null}overview({bounds:[t,e,n,s],focus:r},o=!1){let a=new H(.5*(t+n),.5*(e+s),.6),l=o?1.05:.62,c=n-t>=s-e?-.5*Math.PI:Math.PI,h=o?c:c+.35,d=new H(Math.cos(h)*Math.cos(l),Math.sin(h)*Math.cos(l),Math.sin(l)),u=[];for(let p of[t,n])for(let m of[e,s])for(let x of[0,1.8])u.push(new H(p,m,x));for(let p=0;p<3;p++){let[m,x]=[1,400];for(let g=0;g<20;g++){let _=.5*(m+x);this._look(a,d,_),u.every(b=>this._sees(b))?x=_:m=_}this._look(a,d,x),this._center(a,u),this._away=x}!o&&this._away>yR?(a.set(r[0],r[1],.8),this._look(a,d,vR)):this._look(a,d,this._away),this.controls.target.copy(a),this.controls.update()}update(t){t.frame&&(this.name==="follow"?this._follow(t):this.name==="beside"?this._accompany(t):this.firstPerson?this._ride(t):this.controls.update())}dispose(){this.controls.dispose()}_look(t,e,n){this.camera.position.copy(t).addScaledVector(e,n),this.camera.lookAt(t),this.camera.updateMatrixWorld(),this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert()}_center(t,e){let n=e.map(a=>a.clone().project(this.camera)),s=["x","y"].map(a=>{let l=n.map(c=>c[a]);return .5*(Math.min(...l)+Math.max(...l))}),r=new ir;r.setFromCamera(new Vt(...s),this.camera);let o=r.ray.intersectPlane(new Gn(new H(0,0,1),-t.z),new H);o&&t.copy(o)}_sees(t){let e=t.clone().project(this.camera);return Math.abs(e.x)<.97&&Math.abs(e.y)<.95&&e.z<1}_follow(t){let e=this.followed(t);if(!e)return;let[n,s,r]=t.place(e.kind,e.id),o=new H(n,s,.75*t.height(e.kind,e.id));this._start?(this.camera.position.set(n-4.2*Math.cos(r-.4),s-4.2*Math.sin(r-.4),2.9),this._start=!1):this.camera.position.add(o.clone().sub(this.controls.target)),this.controls.target.copy(o),this.controls.update()}_accompany(t){let e=this.followed(t);if(e){let[n,s]=t.place(e.kind,e.id),r=new H(n,s,0).sub(this._last??new H(this.controls.target.x,this.controls.target.y,0));this.controls.target.add(r),this.camera.position.add(r),this._last=new H(n,s,0)}this.controls.update()}_ride(t){let e=this.head(t),n=e&&t.place(e.kind,e.id);if(!n)return;let[s,r,o]=n,a=e.kind==="robot"?Math.max(.6,t.height("robot",e.id)):xR*t.height("person",e.id),[l,c]=[o+this._gaze[0],this._gaze[1]-bR];this.camera.position.set(s,r,a),this.camera.lookAt(s+Math.cos(l)*Math.cos(c),r+Math.sin(l)*Math.cos(c),a+Math.sin(c))}_turnHead(t,e){this._gaze[0]=Math.max(-Vy,Math.min(Vy,this._gaze[0]+t)),this._gaze[1]=Math.max(-1.2,Math.min(1.2,this._gaze[1]+e))}_key(t){let e={ArrowLeft:[1,0],ArrowRight:[-1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[t.key];if(!e||!t.shiftKey)return;if(t.preventDefault(),this.firstPerson)return this._turnHead(.12*e[0],-.12*e[1]);let n=this.camera.position.clone().sub(this.controls.target),s=new sr().setFromCartesianCoords(n.x,n.z,-n.y);s.theta+=.12*e[0],s.phi=Math.min(this.controls.maxPolarAngle,Math.max(.05,s.phi+.12*e[1]));let r=new H().setFromSpherical(s);this.camera.position.copy(this.controls.target).add(new H(r.x,-r.z,r.y))}};var wR=new H(-.42,-.55,1),ap=22,lp=2048,ou=class{constructor(t,e){this.canvas=t,this.state=new co,this._resource=e,this._renderer=new Zh({canvas:t,antialias:!0,powerPreference:"high-performance"}),this._renderer.shadowMap.enabled=!0,this._renderer.shadowMap.type=Pr,this._renderer.info.autoReset=!1,this._scene=new Ea,this._views=new ru(t),this._layers=new Map(lo.map(n=>[n.name,{...n}])),this._marked=new Map,this._frames=this._applied=this._work=0,this._theme="light",this._build(),this.setTheme(this._theme)}async load(t){let e=this._bodies??Promise.all([...Array(np).keys()].map(a=>this._fetch(`bodies/${a}.bin`)));this._bodies=e;let n=new Map,s=t.robots.map(async a=>{let l=await this._fetch(a.mesh,{key:a.key});n.set(a.key,{arrays:l.arrays,textures:await Ly(l)})}),[r]=await Promise.all([e,...s]);this._crowd||(this._crowd=new Qh(r),this._scene.add(this._crowd.group));let o=JSON.stringify(this.state.description?.bounds)!==JSON.stringify(t.bounds);this.state.describe(t,r[np-1]),this._crowd.dress(t.people,t.regions.length),this._robots.build(t.robots,n),this._stage.build(t,this._look);for(let{name:a,title:l}of t.layers)this._layers.has(a)||this._layers.set(a,{name:a,title:l,visible:a==="scans"});this._showLayers(),this._resize(),o&&(this._views.overview(t),this._views.name==="free"&&t.robots.length&&this._views.choose("beside",t,null))}apply(t){let e=performance.now();if(!this.state.apply(t))return!1;this._crowd.update(this.state,new Set(this._marks("person")),this._markColor,this._look.shade),this._robots.update(this.state,this._hidden("robot")),this._stage.update(t.arrays);for(let[n,s]of Object.entries(this._overlays))s.object.visible&&s.update(this.state,this._look,n);return this._applied=performance.now()-e,!0}layers(){return[...this._layers.values()].map(t=>({...t}))}wanted(){let t=new Set(lo.map(e=>e.name));return this.layers().filter(e=>e.visible&&!t.has(e.name)).map(e=>e.name)}setLayer(t,e){if(!this._layers.has(t))throw new Error(`the scene has no layer ${t}`);this._layers.get(t).visible=e,this._showLayers()}cameras(){return this.state.description?this._views.list(this.state.description):[]}get camera(){return this._views.name}setCamera(t,e=null){this._views.choose(t,this.state.description,e),this._stage.full=t==="follow"||this._views.firstPerson,this.state.frame&&this._robots.update(this.state,this._hidden("robot"))}reset(){this.setCamera("free"),this._views.overview(this.state.description)}pick(t,e){if(!this.state.frame)return null;let{clientWidth:n,clientHeight:s}=this.canvas,r=new ir;r.setFromCamera(new Vt(2*t/n-1,1-2*e/s),this._views.camera);let o=null;for(let a of this._targets()){let l=new H(a.x,a.y,a.z),c=new H(a.x,a.y,a.z+a.height),h=new H;if(r.ray.distanceSqToSegment(l,c,h)>a.radius**2)continue;let d=h.distanceTo(r.ray.origin);(!o||d<o.away)&&(o={kind:a.kind,id:a.id,away:d})}return o&&{kind:o.kind,id:o.id}}floor(t,e){let{clientWidth:n,clientHeight:s}=this.canvas,r=new ir;r.setFromCamera(new Vt(2*t/n-1,1-2*e/s),this._views.camera);let o=r.ray.intersectPlane(new Gn(new H(0,0,1),0),new H);return o&&{x:o.x,y:o.y}}highlight(t,e){this._marked=new Map(t==null?[]:[[`${t} ${e}`,{kind:t,id:e}]]),this._views.target=this._marked.size?{kind:t,id:e}:null,this.state.frame&&this.apply(this.state.frame)}setTheme(t){this._theme=t==="dark"?"dark":"light",this._look=br[this._theme],this._markColor=new Zt(this._look.mark),this._scene.background=new Zt(this._look.sky),this._scene.fog=new Ma(this._look.sky,45,170),this._sun.intensity=this._look.sun,this._dome.intensity=this._look.dome,this._ring.material.color.set(this._look.mark),this.state.description&&(this._stage.build(this.state.description,this._look),this._showLayers(),this.state.frame&&this.apply(this.state.frame))}info(){let{render:t,memory:e}=this._renderer.info,{position:n}=this._views.camera;return{people:this.state.walkers,robots:this.state.frame?this.state.frame.arrays.bots.length:0,levels:this._crowd?[...this._crowd.counts]:[0,0,0],time:this.state.time,sequence:this.state.frame?this.state.frame.sequence:0,calls:t.calls,triangles:t.triangles,geometries:e.geometries,textures:e.textures,frames:this._frames,milliseconds:this._spent,work:this._work,camera:this._views.name,eye:[n.x,n.y,n.z],theme:this._theme}}render(){let t=performance.now();this._resize(),this._views.update(this.state),this._crowd?.choose(this._views.camera,this._renderer.domElement.height,this._hidden("person")),this._light(),this._mark(),this._renderer.info.reset(),this._work=this._applied+performance.now()-t,this._applied=0,this._renderer.render(this._scene,this._views.camera),this._frames+=1,this._spent=performance.now()-t}get engine(){return{renderer:this._renderer,scene:this._scene}}renderFrom(t,e,n=null){let s=performance.now();this._stage.full=!0,this._views.camera.position.copy(e),this._views.controls.target.set(e.x,e.y,0),this._crowd?.choose({position:e,fov:90},2e3,n),this._light(),this._mark(),this._renderer.info.reset(),this._renderer.render(this._scene,t),this._frames+=1,this._spent=performance.now()-s}dispose(){this._views.dispose(),this._crowd?.dispose(),this._robots.dispose(),this._stage.dispose(),this._renderer.dispose()}_build(){this._sun=new Va("#fff8ef",2),this._sun.castShadow=!0,this._sun.shadow.mapSize.set(lp,lp),this._sun.shadow.bias=-6e-4,this._sun.shadow.normalBias=.03,this._sun.shadow.radius=4,this._dome=new za("#f6f9ff","#b9bcc0",1.4),this._stage=new nu,this._robots=new tu,this._overlays=Ay(),this._ring=new Ie(new Rr(.85,1,56),new Wn({depthTest:!1,transparent:!0,opacity:.95})),this._ring.visible=!1,this._scene.add(this._sun,this._sun.target,this._dome,this._stage.group,this._robots.group,this._ring);for(let t of Object.values(this._overlays))this._scene.add(t.object)}async _fetch(t,e){let n=await fetch(this._resource(t,e));if(!n.ok)throw new Error(`${t}: ${(await n.text()).trim()}`);return Fs(await n.arrayBuffer())}_hidden(t){let e=this._views.head(this.state);return e?.kind===t?e.id:null}_marks(t){return[...this._marked.values()].filter(e=>e.kind===t).map(e=>e.id)}_mark(){let[t]=this._marked.values(),e=t&&this.state.place(t.kind,t.id);if(this._ring.visible=!!e&&this._hidden(t.kind)!==t.id,!e)return;let n=t.kind==="robot"?this.state.description.robots.find(s=>s.id===t.id).radius+.12:.42;this._ring.position.set(e[0],e[1],.02),this._ring.scale.setScalar(n)}_targets(){let{ids:t,pelvis:e,bots:n,botplace:s}=this.state.frame.arrays,r=Array.from(t,(a,l)=>({kind:"person",id:a,x:e[3*l],y:e[3*l+1],z:e[3*l+2]-.9,height:this.state.height("person",a),radius:.3}));return[...Array.from(n,(a,l)=>{let{id:c,radius:h,height:d}=this.state.description.robots[a];return{kind:"robot",id:c,x:s[5*l],y:s[5*l+1],z:0,height:d,radius:h}}),...r]}_showLayers(){let t=e=>this._layers.get(e)?.visible??!1;for(let e of["walls","props","zones"])this._stage.parts[e].visible=t(e);this._stage.grid=t("grid"),this._robots.group.visible=t("robots");for(let[e,n]of Object.entries(this._overlays))n.object.visible=t(e);this._crowd&&(this._crowd.group.visible=t("people"),this._crowd.shadows=t("shadows")),this._stage.shadows=this._robots.shadows=this._sun.castShadow=t("shadows")}_light(){let t=this._views.controls.target,e=this._views.camera.position,n=Math.min(ap,Math.max(7,.75*e.distanceTo(t))),s=this._views.firstPerson?e:t,r=this._sun.shadow.camera;r.left=r.bottom=-n,r.right=r.top=n,r.near=1,r.far=4*ap,r.updateProjectionMatrix();let o=2*n/lp;this._sun.target.position.set(o*Math.round(s.x/o),o*Math.round(s.y/o),0),this._sun.position.copy(this._sun.target.position).addScaledVector(wR.clone().normalize(),2*ap)}_resize(){if(this._renderer.xr.isPresenting)return;let t=Math.min(2,devicePixelRatio||1),{clientWidth:e,clientHeight:n}=this.canvas;!e||!n||e===this._width&&n===this._height&&t===this._ratio||(Object.assign(this,{_width:e,_height:n,_ratio:t}),this._renderer.setPixelRatio(t),this._renderer.setSize(e,n,!1),this._views.camera.aspect=e/n,this._views.camera.updateProjectionMatrix())}};var al=class{constructor(){this._arrays=new Map}copy(t,e){let n=this._arrays.get(t);(!n||n.buffer.byteLength<e.byteLength||n.constructor!==e.constructor)&&(n=new e.constructor(Math.ceil(1.25*e.length)+16),this._arrays.set(t,n));let s=n.subarray(0,e.length);return s.set(e),s}},SR={place:5,pelvis:3,bones:112};function Xy(i,t,e,n=new al){if(e<=0||i.arrays.revision[0]!==t.arrays.revision[0])return i;if(e>=1)return t;let s={...t.arrays},r=MR(i.arrays.ids,t.arrays.ids);for(let[o,a]of Object.entries(SR))s[o]=au(n.copy(o,t.arrays[o]),i.arrays[o],t.arrays[o],r,a,e,o==="bones"?0:-1);if($y(s.place,i.arrays.place,t.arrays.place,r,e),cp(i.arrays.bots,t.arrays.bots)){let o=Array.from(t.arrays.bots,(l,c)=>c);s.botplace=au(n.copy("botplace",t.arrays.botplace),i.arrays.botplace,t.arrays.botplace,o,5,e,-1),$y(s.botplace,i.arrays.botplace,t.arrays.botplace,o,e);let a=Array.from({length:t.arrays.links.length/7},(l,c)=>c);s.links=au(n.copy("links",t.arrays.links),i.arrays.links,t.arrays.links,a,7,e,3)}if(s.props&&cp(i.arrays.propnum??[],s.propnum)){let o=Array.from(s.propnum,(a,l)=>l);s.props=au(n.copy("props",t.arrays.props),i.arrays.props,t.arrays.props,o,7,e,3)}for(let o of Object.keys(i.arrays))(/^(scan|pose|cloud)\d+$/.test(o)||o==="cones"||o==="forces")&&(s[o]=i.arrays[o]);return{...t,time:i.time+e*(t.time-i.time),arrays:s}}function MR(i,t){if(cp(i,t))return Array.from(t,(n,s)=>s);let e=new Map(Array.from(i,(n,s)=>[n,s]));return Array.from(t,n=>e.get(n)??-1)}function cp(i,t){return i.length===t.length&&i.every((e,n)=>e===t[n])}function au(i,t,e,n,s,r,o){for(let a=0;a<n.length;a++){let l=n[a];if(l<0)continue;let[c,h]=[l*s,a*s],d=o<0?s:o;for(let u=0;u<d;u++)i[h+u]=t[c+u]+r*(e[h+u]-t[c+u]);for(let u=d;u<s;u+=4){let p=0;for(let x=u;x<u+4;x++)p+=t[c+x]*e[h+x];let m=p<0?-1:1;for(let x=u;x<u+4;x++)i[h+x]=t[c+x]+r*(m*e[h+x]-t[c+x])}}return i}function $y(i,t,e,n,s){n.forEach((r,o)=>{if(r<0)return;let a=t[5*r+2],l=e[5*o+2]-a;i[5*o+2]=a+s*Math.atan2(Math.sin(l),Math.cos(l))})}var ER=.3,TR=12,AR=250,RR=.25,qy=3,lu=class{constructor(){this._frames=[],this._buffer=new al,this._interval=50,this._arrival=null,this._shown=0,this._rate=0,this._last=0,this._drawn=null}get moving(){return this._frames.length>1||this._frames.length===1&&this._drawn!==this._frames[0]}get newest(){return this._frames.at(-1)??null}clear(){this._frames=[],this._arrival=this._drawn=null}push(t,e){let n=this.newest;if(this._arrival!==null){let r=Math.min(AR,Math.max(TR,e-this._arrival));this._interval+=RR*(r-this._interval)}this._arrival=e;let s=n?t.time-n.time:-1;!(s>0&&s<=ER)||n.arrays.revision[0]!==t.arrays.revision[0]?(this._frames=[t],this._shown=t.time,this._rate=0):(this._move(e),this._frames.push(t),this._frames.length>qy&&this._frames.splice(0,this._frames.length-qy),this._shown=Math.max(this._shown,this._frames[0].time),this._rate=(t.time-this._shown)/this._interval),this._last=e}at(t){if(this._move(t),!this._frames.length)return null;let[e,n]=this._frames,s=n?(this._shown-e.time)/(n.time-e.time):0;return this._drawn=Xy(e,n??e,s,this._buffer),this._drawn}_move(t){for(this._shown+=this._rate*Math.max(0,t-this._last),this._last=t;this._frames.length>1&&this._shown>=this._frames[1].time;)this._frames.shift();this._frames.length===1&&(this._shown=this._frames[0].time,this._rate=0)}};function Yy(i,{bounds:t,walls:e,discs:n,since:s},r){let o=Math.min(2,devicePixelRatio||1),[a,l]=[i.clientWidth*o,i.clientHeight*o];(i.width!==a||i.height!==l)&&Object.assign(i,{width:a,height:l});let c=i.getContext("2d"),h=r==="dark",[d,u,p,m]=t,x=.92*Math.min(a/(p-d),l/(m-u)),_=matchMedia("(prefers-reduced-motion: reduce)").matches?0:(performance.now()-s)/1e3%12;c.setTransform(1,0,0,1,0,0),c.fillStyle=h?"#141a21":"#e3e9f0",c.fillRect(0,0,a,l),c.setTransform(x,0,0,-x,.5*a-.5*x*(d+p),.5*l+.5*x*(u+m)),c.lineWidth=2/x,c.strokeStyle=h?"#a9b7c4":"#6c7884";for(let b of e)c.beginPath(),b.forEach(([S,y],C)=>C?c.lineTo(S,y):c.moveTo(S,y)),b.length>2&&c.closePath(),c.stroke();for(let[b,S,y,C,E,v]of n)c.beginPath(),c.fillStyle=v?"#d55e00":"#0072b2",c.arc(b+y*_,S+C*_,E,0,2*Math.PI),c.fill()}var CR=800,PR=5,qo=class{constructor(t,e,n="simulator"){this.app=t,this.desk=n,this.actions=e,this.placing=!1,this.frames=0,this.motion=new lu,this._waiting=null,this._loading=null,this._awake=0,this._shown=!0,this.place=f("div",{class:"stage-place"}),this.overlay=f("canvas",{class:"preview","aria-hidden":"true",hidden:!0}),this.note=f("p",{class:"picture-note",role:"status"}),this.element=f("div",{class:"picture"},this.place,this.overlay,this.note),this._make(t.address.get("view")??"3d"),this._listen(),requestAnimationFrame(()=>this._tick())}take(t){if(!(!this._shown||!this.scene))return this._finish(),this.motion.push(t,performance.now()),new Promise(e=>{this._waiting=e})}preview(t){this._preview=t&&{...t,since:performance.now()},this.overlay.hidden=!t,t&&this.forget()}get newest(){return this.motion.newest}forget(){this.motion.clear()}say(t){this.note.textContent!==t&&(this.note.textContent=t),this.note.hidden=!t}set shown(t){this._shown=t,t||this._finish(),this.wake()}wake(){this._awake=performance.now()+CR}mark(t,e){this.scene?.state.frame&&this.scene.highlight(t,e),this.wake()}setView(t){t!==this.view&&(this.scene.dispose(),this._make(t),this.app.remember({view:t}),this.app.connection.call(`${this.desk}.show_frame`).catch(()=>{}))}_make(t){this.canvas=f("canvas",{class:"stage",tabindex:"0",role:"img","aria-label":"Picture of the simulation"}),this.place.replaceChildren(this.canvas);let e=(n,s)=>this.app.connection.address(this.desk,n,s);this.view=t==="2d"?"2d":"3d";try{this.scene=this.view==="2d"?new Ql(this.canvas,e):new ou(this.canvas,e)}catch(n){return me(`The picture in space needs WebGL, so the one from above is shown: ${n.message}`,"error"),this._make("2d")}return this.scene.setTheme(this.app.theme),this._listenCanvas(),this.wake()}_listen(){document.addEventListener("theme",t=>{this.scene?.setTheme(t.detail),this.wake()}),new ResizeObserver(()=>this.wake()).observe(this.element)}_listenCanvas(){let t=null;for(let e of["pointermove","wheel","keydown"])this.canvas.addEventListener(e,()=>this.wake(),{passive:!0});this.canvas.addEventListener("pointerdown",e=>{t=[e.offsetX,e.offsetY],this.wake()}),this.canvas.addEventListener("pointerup",e=>{!t||Math.hypot(e.offsetX-t[0],e.offsetY-t[1])>PR||e.button!==0||this._click(e.offsetX,e.offsetY)})}_click(t,e){if(this.scene?.state.frame)if(this.placing){let n=this.scene.floor(t,e);n&&this.actions.place(n)}else this.actions.select(this.scene.pick(t,e))}_finish(){this._waiting?.(),this._waiting=null}_tick(){if(requestAnimationFrame(()=>this._tick()),!this._shown||!this.scene||!this.canvas.clientWidth)return this._finish();if(this._preview&&Yy(this.overlay,this._preview,this.app.theme),!(this._waiting===null&&!this.motion.moving&&performance.now()>this._awake))return this._waiting!==null&&(this.frames+=1),this._apply(),this.scene.state.frame&&this.scene.render(),this._finish()}_apply(){let t=this._loading?null:this.motion.at(performance.now());t&&(this.scene.apply(t)?this.preview(null):this._loading=this._load().catch(e=>me(e.message,"error")))}async _load(){try{let t=await this.app.connection.call(`${this.desk}.description`);t.revision!==void 0&&(await this.scene.load(t),this.actions.loaded?.(t)),this.motion.newest&&this.scene.apply(this.motion.newest)&&this.preview(null),this.wake()}finally{this._loading=null}this.app.connection.call(`${this.desk}.show_frame`).catch(()=>{})}};function IR({send:i,record:t=[]}){let e=[i?"events and poses are sent":"",t.length?`recorded: ${t.join(", ")}`:""].filter(Boolean);return e.length?f("p",{class:"note"},`Lab Streaming Layer: ${e.join("; ")}`):null}var hp=class{constructor(t,e){Object.assign(this,{root:t,app:e,state:{open:!1},form:null}),this.participant=e.address.get("role")==="participant",this.trial=new qo(e,{select(){},place(){}},"experiments"),this.screen=f("div",{class:"screen","aria-live":"polite"}),this.side=f("aside",{"aria-label":"Operator"}),t.classList.add("experiments"),this.participant&&document.body.classList.add("participant"),pt(t,this.screen,this.participant?null:this.side),e.connection.on("experiments.state",n=>this.update(n)),e.connection.on("experiments.progress",n=>this.progress(n)),e.connection.draw("trial",n=>this.trial.take(n))}async call(t,e={}){let n=await he(()=>this.app.connection.call(`experiments.${t}`,e));return n&&"open"in n&&this.update(n),n}update(t){let e=JSON.stringify(t)===JSON.stringify(this.state)&&this.drawn;this.state=t,!e&&(this.drawn=!0,this.form=null,t.open?t.phase==="screen"?this.showScreen():t.phase==="running"?this.showTrial():t.phase==="pause"?this.showPause():this.showEnd():this.showStart(),this.participant||this.showOperator())}async showStart(){if(this.participant)return pt(this.screen,f("h2",{},"The experiment has not started yet."));let t=await this.call("sources");if(!t)return;let e=f("p",{class:"about"}),n=()=>e.textContent=t.find(p=>p.name===s.value)?.about??"",s=f("select",{onchange:()=>n()},t.map(p=>f("option",{value:p.name},p.name)));n();let r=f("input",{type:"number",min:1,value:1}),o=f("input",{type:"number",min:.1,max:100,step:"any",value:1}),a=f("input",{type:"checkbox"}),{send:l,record:c}=this.state.streams??{},h=f("input",{type:"checkbox",checked:!!l}),d=f("input",{type:"text",value:(c??[]).join(", "),placeholder:"pulse, type=EEG"}),u=()=>{let p=d.value.split(",").map(m=>m.trim()).filter(Boolean);return this.call("open",{experiment:s.value,participant:Number(r.value),resume:a.checked,rate:Number(o.value),send_streams:h.checked,record_streams:p})};pt(this.screen,f("h2",{},"Start a session"),en("Experiment",s),e,en("Participant",r),en("Speed of the trials (1: real time)",o),f("label",{class:"option"},a,"Continue an interrupted session"),f("label",{class:"option"},h,"Send events and poses (Lab Streaming Layer)"),en("Streams to record (Lab Streaming Layer)",d),f("p",{},f("button",{type:"button",class:"main",onclick:u},"Start")))}showScreen(){let{html:t,questions:e,answers:n}=this.state;this.form=t0(e,n);let s=f("button",{type:"submit",class:"main"},"Continue"),r=f("form",{onsubmit:o=>this.submit(o)},jg(t),this.form.element,f("p",{},s));pt(this.screen,r)}async submit(t){t.preventDefault();let e=this.form.missing();if(e.length)return me(`Please answer: ${e.join("; ")}`,"error");let n=this.form.values();if(!(Object.keys(n).length&&!await this.call("answer",{answers:n})))return this.call("next")}showTrial(){this.bar=f("progress",{max:1,value:0,"aria-label":"Progress of the trial"}),pt(this.screen,f("h2",{},"Watch the trial"),f("div",{class:"trial"},this.trial.element),this.bar),this.trial.wake()}progress(t){this.bar&&(this.bar.value=t)}showPause(){let e=this.state.waiting==="failed"?`The trial has failed: ${this.state.reason}`:"The experiment is paused.";pt(this.screen,f("h2",{},this.participant?"Please wait.":e))}showEnd(){let t=this.state.phase==="done"?"The session is complete. Thank you.":`The session has ended: ${this.state.reason||this.state.phase}`;pt(this.screen,f("h2",{},t))}showOperator(){let{state:t}=this;if(!t.open)return pt(this.side,f("h2",{},"Operator"),f("p",{class:"note"},"Start a session. A second window for the participant can be opened then."));let e=o=>t.possible.includes(o),n=(o,a,l)=>e(a)?f("button",{type:"button",onclick:()=>this.call(a,l)},o):null,s=t.phase==="pause"&&e("next")?f("button",{type:"button",onclick:()=>this.call("next")},"Continue without this trial"):null,r=t.phase==="done"||t.phase==="aborted";return pt(this.side,f("h2",{},`${t.experiment}, participant ${t.participant}`),f("p",{},`State: ${t.phase}${t.reason?` (${t.reason})`:""}`),f("ol",{class:"steps"},t.steps.map((o,a)=>this.step(o,a))),f("div",{class:"row"},n("Pause","pause"),n("Resume","resume"),n("Repeat the trial","repeat"),s),f("div",{class:"row"},e("abort")?f("button",{type:"button",onclick:()=>this.askAbort()},"Abort"):null,f("button",{type:"button",onclick:()=>this.call("leave")},r?"New session":"Leave for now"),f("button",{type:"button",onclick:()=>this.showAnswers()},"Answers")),f("p",{},f("a",{href:this.participantAddress(),target:"_blank",rel:"noopener"},"Window for the participant")),f("p",{class:"note"},`Files: ${t.folder}`),IR(t.streams))}step(t,e){let{index:n,outcomes:s,phase:r}=this.state,o=r==="done"||e<n,a=`${t.name} (${t.role})${s[e]?`: ${s[e]}`:""}`;return f("li",{"aria-current":e===n&&!o?"step":null,class:o?"over":""},a)}participantAddress(){let t=new URLSearchParams(this.app.address);return t.set("role","participant"),t.set("tab","experiments"),`?window=participant#${t}`}askAbort(){let t=f("input",{type:"text"});we("End the session permanently?",en("Reason",t),[["Cancel",()=>!0],["Abort the session",()=>{this.call("abort",{reason:t.value||"operator"})}]])}async showAnswers(){let t=await this.call("answers");if(!t)return;let e=[...new Set(t.flatMap(Object.keys))],n=r=>f("td",{},r==null?"":String(r)),s=f("table",{},f("thead",{},f("tr",{},e.map(r=>f("th",{scope:"col"},r)))),f("tbody",{},t.map(r=>f("tr",{},e.map(o=>n(r[o]))))));we("Answers",t.length?s:f("p",{},"No answers yet."))}},Zy={name:"experiments",title:"Experiments",mount(i,t){let e=new hp(i,t);return{tab:e,greet:n=>e.update(n)}}};function dn(i,t=()=>{}){let e=i.map(r=>[r,LR(r)]);for(let[,r]of e)r.addEventListener("change",t);return{element:f("div",{class:"form"},e.map(([r,o])=>en(r.unit?`${r.label} [${r.unit}]`:r.label,o,r.note))),values:()=>Object.fromEntries(e.map(([r,o])=>[r.name,DR(r,o)]))}}function LR(i){if(i.kind==="choice"||i.kind==="several"){let e=i.kind==="several";return f("select",{name:i.name,multiple:e,size:e?Math.min(8,Math.max(3,i.choices.length)):null},i.choices.map(n=>{let[s,r]=Array.isArray(n)?n:[n,n];return f("option",{value:s,selected:e?i.value.includes(s):s===i.value},r)}))}if(i.kind==="switch")return f("input",{name:i.name,type:"checkbox",checked:i.value===!0});if(i.kind==="text")return f("input",{name:i.name,type:"text",value:i.value??""});let t=i.step??(i.kind==="whole"?1:"any");return f("input",{name:i.name,type:"number",value:i.value??"",min:i.low,max:i.high,step:t})}function DR(i,t){return i.kind==="switch"?t.checked:i.kind==="several"?[...t.selectedOptions].map(e=>e.value):i.kind==="number"||i.kind==="whole"?t.value===""?null:Number(t.value):t.value}async function Cs(i,t="Copy"){let e=f("textarea",{readonly:!0,rows:Math.min(16,i.split(`
`).length+2),cols:78,"aria-label":"Text"});e.value=i;let n="copied to the clipboard";try{await navigator.clipboard.writeText(i)}catch{n="copy the text with Ctrl+C"}we(t,[e,f("p",{class:"hint"},n)]),e.select()}var NR={waiting:"\u2026",running:"\u25B6",done:"\u2713",failed:"\u2717",cancelled:"\u25A0",interrupted:"!"},UR=matchMedia("(prefers-reduced-motion: reduce)"),ur={bytes:i=>i<1e6?`${(i/1e3).toFixed(0)} kB`:i<1e9?`${(i/1e6).toFixed(1)} MB`:`${(i/1e9).toFixed(2)} GB`,seconds:i=>i<90?`${i.toFixed(0)} s`:i<5400?`${(i/60).toFixed(0)} min`:`${(i/3600).toFixed(1)} h`};function Ky(i,t){let e=i.state==="waiting"||i.state==="running",n=(c,h)=>f("button",{type:"button","aria-label":`${c} ${i.title}`,onclick:()=>h(i)},c),s=f("progress",{max:1,value:i.share,"aria-label":`Progress of ${i.title}`}),r=f("span",{class:"note"}),o=c=>{Object.assign(i,c),i.state==="running"&&i.share===0&&!UR.matches?s.removeAttribute("value"):s.value=i.share;let h=e?`${Math.round(100*i.share)} %, `:"",d=new Date(1e3*i.created).toLocaleString([],{dateStyle:"short",timeStyle:"short"});r.textContent=`${h}${ur.seconds(i.seconds)}, ${i.state==="waiting"?"added":"started"} ${d}${e&&i.note?` \xB7 ${i.note}`:""}`},a=f("button",{type:"button",class:"link",onclick:()=>Cs(i.command,"Copy as command line")},"Copy command"),l=f("li",{class:`job ${i.state}`,"data-number":i.number},f("div",{class:"job-head"},f("span",{class:"sign","aria-hidden":"true"},NR[i.state]),f("strong",{},i.title),f("span",{class:"kind"},i.kind),f("span",{class:"state"},i.state)),e?s:null,r,i.problem?f("p",{class:"problem"},i.problem):null,i.command?f("p",{class:"command"},f("code",{},i.command)):null,f("div",{class:"row"},e?n("Cancel",t.cancel):null,!e&&i.words.length?n(i.state==="done"?"Run again":"Continue",t.again):null,i.words.length?n("Log",t.log):null,!e&&i.results?n("Results",t.results):null,e?null:n("Remove",t.remove),i.command?a:null));return o(i),{element:l,update:o}}var up=class{constructor(t,e){Object.assign(this,{app:e,root:t,kind:null,rows:new Map,state:{jobs:[]}}),this.form=f("div",{}),this.starters=f("div",{class:"starters"}),this.list=f("ul",{class:"jobs-list","aria-label":"List of jobs"}),this.summary=f("p",{class:"note","aria-live":"polite"}),t.classList.add("jobs"),pt(t,f("aside",{"aria-label":"New job"},f("h2",{},"New job"),this.starters,this.form),f("div",{class:"results"},f("h2",{},"Jobs"),this.summary,this.list)),e.connection.on("jobs.state",n=>this.take(n)),e.connection.on("jobs.progress",n=>this.progress(n))}call(t,e={}){return he(()=>this.app.connection.call(`jobs.${t}`,e))}async greet(t){this.take(t),await this.refresh()}async refresh(){let t=await this.call("forms");t&&(this.forms=t,pt(this.starters,t.map(e=>f("button",{type:"button","aria-pressed":String(e.kind===this.kind),onclick:()=>this.choose(e.kind)},e.title))),this.choose(this.kind??this.app.address.get("job")??t[0].kind))}choose(t){let e=this.forms.find(o=>o.kind===t)??this.forms[0];this.kind=e.kind,this.app.keys.active==="jobs"&&this.app.remember({job:e.kind}),[...this.starters.children].forEach((o,a)=>o.setAttribute("aria-pressed",String(this.forms[a]===e)));let n=dn(e.rows),s=async o=>{o.preventDefault(),await this.call("begin",{kind:e.kind,values:n.values()})},r=async()=>{let o=await this.call("words",{kind:e.kind,values:n.values()});o!==void 0&&await Cs(o,"Copy as command line")};pt(this.form,f("p",{class:"note"},e.about),f("form",{onsubmit:s,"aria-label":e.title},n.element,f("div",{class:"row"},f("button",{type:"submit",class:"main"},"Start"),f("button",{type:"button",onclick:r},"Copy as command line"))))}take(t){this.state=t;let e={cancel:r=>this.call("cancel",{number:r.number}),again:r=>this.call("again",{number:r.number}),log:r=>this.showLog(r),results:r=>this.showResults(r),remove:r=>this.askRemove(r)},n=document.activeElement?.closest?.(".job")?.dataset.number;this.rows=new Map(t.jobs.map(r=>[r.number,Ky(r,e)]));let s=f("li",{class:"empty"},"No job yet. Training, generation, searches, evaluations and predictions that run are listed here, also after a reload.");pt(this.list,t.jobs.length?[...this.rows.values()].map(r=>r.element):s),n&&this.rows.get(Number(n))?.element.querySelector("button")?.focus(),this.summarize()}progress(t){this.rows.get(t.number)?.update(t);let e=this.state.jobs.find(n=>n.number===t.number);e&&Object.assign(e,t)}summarize(){let{jobs:t,cpu:e,cpu_limit:n,memory_limit:s,disk:r,disk_limit:o,at_once:a}=this.state,l=h=>t.filter(d=>d.state===h).length,c=[`${l("running")} running, ${l("waiting")} waiting (at most ${a} at once)`];c.push(`processor ${ur.seconds(e??0)}${n?` of ${ur.seconds(n)}`:""}`),s&&c.push(`memory of a job at most ${ur.bytes(s)}`),c.push(`folder ${ur.bytes(r??0)}${o?` of ${ur.bytes(o)}`:""}`),this.summary.textContent=c.join(" \xB7 ")}async showLog(t){let e=await this.call("log",{number:t.number});if(e===void 0)return;let n=f("pre",{class:"log",tabindex:"0",role:"region","aria-label":"Log"},e||"The log is empty.");we(`Log of ${t.title}`,n,[["Copy",()=>(Cs(e,"Log"),!1)],["Close",()=>!0]]),n.scrollTop=n.scrollHeight}async showResults(t){let e=await this.call("files",{number:t.number});if(!e)return;let n=r=>this.app.connection.address("jobs",`${t.number}/${r}`),s=r=>{let o=r.name.endsWith(".html"),a=f("a",{href:n(`files/${r.name}`),...o?{target:"_blank",rel:"noopener"}:{download:r.name.split("/").at(-1)}},r.name);return f("tr",{},f("td",{},a),f("td",{class:"number"},ur.bytes(r.bytes)))};we(`Results of ${t.title}`,f("div",{},f("p",{class:"note"},`In the folder ${t.results} of the app. `,f("a",{href:n("all.zip"),download:`${t.title}.zip`},"All as one file")),f("table",{},f("thead",{},f("tr",{},f("th",{scope:"col"},"File"),f("th",{scope:"col",class:"number"},"Size"))),f("tbody",{},e.map(s)))))}askRemove(t){let e=[["Keep it",()=>!0]];t.results&&e.push(["Remove with results",()=>{this.call("remove",{number:t.number,results:!0})}]),e.push(["Remove from the list",()=>{this.call("remove",{number:t.number})}]),we(`Remove ${t.title}?`,f("p",{},t.results?`Its results are in ${t.results}.`:"It has no results of its own."),e)}},Jy={name:"jobs",title:"Jobs",mount(i,t){let e=new up(i,t);return{tab:e,greet:n=>e.greet(n),show:()=>e.forms&&e.refresh()}}};var jy=[[],[9,5],[2,4],[9,4,2,4],[16,5]],FR=[1,3];function Or(i,t="clean"){let e=t==="degraded"?FR:jy[(i+Math.floor(i/6))%jy.length];return{name:`--data-${i%6+1}`,dash:e}}function dp(i){return wn(Or(i).name)}var Qy=[{variable:"ade",person:null},{variable:"time",person:null}],OR=400;function tv(i){let t=f("div",{}),e=Qy.map(u=>({...u})),n={key:"",plot:null},s=null;async function r(){if(s=null,!i.recording)return;for(let p of[...e])await o(p);let u=await i.call("results");u&&(l(u.horizon),i.emit("results",u))}async function o(u){if(!(await i.call("variables"))?.some(_=>_.name===u.variable))return;let m=await i.call("series",{variable:u.variable,person:u.person});if(!m||!e.includes(u))return;let x=m.rows.filter(_=>_.values.some(b=>b!==null)),g=u.person===null?m.label:`${m.label} of person ${u.person}`;a(u,g,{label:"Frame"},x,m.unit,m.frames),u.plot?.mark(m.frames[i.index])}function a(u,p,m,x,g,_,b=!1){let S=JSON.stringify([p,g,x.map(y=>[y.slot,y.input,y.label])]);if(S!==u.key){u.plot?.destroy(),u.box?.remove(),u.key=S,u.box=f("div",{class:"plot-box"}),u.variable&&!Qy.some(C=>C.variable===u.variable&&u.person===null)&&u.box.append(f("button",{type:"button",class:"close","aria-label":`Remove plot ${p}`,onclick:()=>c(u)},"\xD7")),t.insertBefore(u.box,u===n?null:n.box??null);let y=x.map(C=>{let{name:E,dash:v}=Or(C.slot,C.input);return{label:C.label+(C.input==="degraded"?" (degraded)":""),unit:g,colour:E,dash:v}});u.plot=Gl(u.box,{title:p,x:m,series:y,points:b,legend:!1,height:150,log:u.variable==="time"})}u.plot.set([_,...x.map(y=>y.values)])}function l({seconds:u,rows:p,unit:m}){a(n,"Error by horizon",{label:"Time ahead",unit:"s"},p,m,u,!0)}function c(u){e.splice(e.indexOf(u),1),u.plot?.destroy(),u.box?.remove()}let h=()=>{s??=setTimeout(r,OR)};i.on("board lines ended",h),i.on("index",()=>{for(let u of e)u.plot?.mark(i.recording?.frames[i.index]??null)}),i.on("plot",u=>{e.push({...u}),h()});let d=f("button",{type:"button",onclick:()=>kR(i)},"Add plot\u2026");return f("section",{"aria-label":"Plots"},f("div",{class:"heading"},f("h2",{},"Plots"),d),t)}async function kR(i){let t=await i.call("variables");if(!t)return;let e=dn([{name:"variable",label:"Variable",kind:"choice",value:"cost",choices:t.map(n=>[n.name,n.unit?`${n.label} [${n.unit}]`:n.label])},{name:"person",label:"Person",kind:"whole",value:i.person,low:0,note:"empty: everybody; parameters are then medians over people"}]);we("Add plot",e.element,[["Cancel",()=>!0],["Add",()=>(i.emit("plot",e.values()),!0)]])}var ev=["","none"];function nv(i){let{models:t,costs:e,searches:n,goals:s,crowd:r}=i.tables,o=x=>x.map(g=>[g.name,g.name]),a=dn([{name:"model",label:"Simulation model",kind:"choice",value:"orca",choices:o(t)},{name:"cost",label:"Cost function",kind:"choice",value:"progressive",choices:[ev,...o(e)]},{name:"search",label:"Search (calibrator)",kind:"choice",value:"genetic",choices:[ev,...o(n)],note:"without cost and search, the parameters below are used"},{name:"goal",label:"Goals of the people",kind:"choice",value:"",choices:[["","current-direction"],...o(s).filter(([x])=>x!=="current-direction")]},{name:"budget",label:"Budget: candidate crowds per frame",kind:"whole",value:500,low:1,high:1e5},{name:"tolerance",label:"Stop at a cost of",unit:"m",kind:"number",low:0,note:"empty: never"},{name:"patience",label:"Stop after evaluations without improvement",kind:"whole",low:1,note:"empty: never"},{name:"samples",label:"Futures per person",kind:"whole",value:1,low:1,high:100,note:"more than one only for goals with several destinations"},{name:"learnt",label:"From the learning part of the recording",kind:"choice",value:"",choices:[["","nothing"],["prior","a prior of the parameters"],["shared","one set of parameters for everybody"]]}],()=>p()),l=f("p",{class:"hint"}),c=f("fieldset",{}),h=null,d=[],u=null;function p(){let{model:x,cost:g,search:_,goal:b}=a.values(),S=t.find(E=>E.name===x),y=[S,ll(e,g),ll(n,_),ll(s,b||"current-direction")];if(pt(l,y.filter(Boolean).map(E=>f("span",{class:"about"},`${E.name}: ${E.about}`))),u===x)return;u=x;let C=[...S.parameters,...r.filter(E=>!S.parameters.some(v=>v.name===E.name))];h=dn(C),d=S.free.map(E=>f("input",{type:"checkbox",value:E})),pt(c,f("legend",{},`Parameters of ${x}`),h.element,f("p",{},"Calibrated parameters (none chosen: all)"),f("div",{class:"checks"},d.map(E=>f("label",{},E,E.value.replaceAll("_"," ")))))}p();let m=async()=>{let{goal:x,...g}=a.values(),_=d.filter(S=>S.checked).map(S=>S.value),b={predictor:"simulated",...g,goal:x,free:_,values:h.values(),samples:g.samples??1};return await i.call("add",{settings:b})!==void 0};we("Add sim predictor",[a.element,l,c],[["Cancel",()=>!0],["OK",m]])}async function iv(i){let t=await i.call("weights")??[],{predictors:e}=i.tables,n=[["Baselines",e.filter(h=>!h.learned)],["Learned",e.filter(h=>h.learned)]],s=f("select",{name:"predictor"},n.map(([h,d])=>f("optgroup",{label:h},d.map(u=>f("option",{value:u.name,selected:u.name==="constant-velocity"},u.name))))),r=f("p",{class:"hint"}),o=f("div",{}),a=null;function l(){let h=ll(e,s.value),d={name:"samples",label:"Futures per person",kind:"whole",value:20,low:1,high:100,note:"drawn as a fan of paths, or as a density"};pt(r,h.about);let u=t.map(m=>[m,m.split("/").at(-2)]),p={name:"weights",label:"Weights",kind:"choice",value:"",choices:[["","those that ship"],...u],note:"Jobs, Train a predictor makes more"};a=dn([...h.weights?[p]:[],...h.samples?[d]:[],...h.parameters]),pt(o,a.element)}s.addEventListener("change",l),l();let c=async()=>{let{samples:h=1,weights:d="",...u}=a.values(),p={predictor:s.value,samples:h??1,values:u,weights:d};return await i.call("add",{settings:p})!==void 0};we("Add base predictor",[f("label",{class:"field"},f("span",{},"Predictor"),s),r,o],[["Cancel",()=>!0],["OK",c]])}function sv(i){let{degradations:t}=i.tables,e=f("select",{name:"degradation"},t.map(l=>f("option",{value:l.name,selected:l.name==="gaussian-noise"},l.name))),n=f("p",{class:"hint"}),s=f("div",{}),r=null;function o(){let l=ll(t,e.value);pt(n,`${l.about} Usual levels of ${l.level.replaceAll("_"," ")}: ${l.levels.join(", ")}.`),r=dn(l.parameters),pt(s,r.element)}e.addEventListener("change",o),o();let a=async()=>await i.call("degrade",{name:e.value,values:r.values()})!==void 0;we("Degrade the input",[f("label",{class:"field"},f("span",{},"Degradation"),e),n,s],[["Cancel",()=>!0],["OK",a]])}var ll=(i,t)=>i.find(e=>e.name===t);var rv="http://www.w3.org/2000/svg";function ov(i){let t=f("ul",{class:"predictors","aria-label":"List of predictors"}),e=f("div",{}),n=new Map;return i.on("progress",({key:s,input:r,...o})=>{!r||o.state==="done"||!n.has(s)||pt(n.get(s),r==="degraded"?`degraded: ${cu(o)}`:cu(o))}),i.on("board",()=>{pt(t,i.board.predictors.length?i.board.predictors.map(s=>BR(i,s,n)):f("li",{class:"hint"},"none yet")),pt(e,zR(i))}),f("section",{"aria-label":"Predictors"},f("h2",{},"Predictors"),f("div",{class:"buttons"},f("button",{type:"button",onclick:()=>nv(i)},"Add sim predictor\u2026"),f("button",{type:"button",onclick:()=>iv(i)},"Add base predictor\u2026")),t,e)}function hu(i,t="clean"){let{name:e,dash:n}=Or(i,t),s=document.createElementNS(rv,"svg"),r=document.createElementNS(rv,"line");for(let[o,a]of Object.entries({width:34,height:10,"aria-hidden":"true"}))s.setAttribute(o,a);for(let[o,a]of Object.entries({x1:1,y1:5,x2:33,y2:5,"stroke-width":2.5,"stroke-dasharray":n.join(" ")}))r.setAttribute(o,a);return r.style.stroke=`var(${e})`,s.append(r),s}function BR(i,t,e){let{clean:n,degraded:s}=t.results,r=[n&&cu(n),s&&`degraded: ${cu(s)}`].filter(Boolean),o=f("input",{type:"checkbox",checked:!i.hidden.has(t.key),"aria-label":`Draw ${t.label}`});return o.addEventListener("change",()=>i.hide(t.key,!o.checked)),e.set(t.key,f("small",{},r.join("; ")||"not run yet")),f("li",{},o,hu(t.slot),f("span",{class:"name",title:[t.name,...r].join(`
`)},t.label,e.get(t.key)),t.calibrated&&f("button",{type:"button","aria-label":`Fit\u2026 of ${t.label}`,onclick:()=>HR(i,t.key)},"Fit\u2026"),f("button",{type:"button","aria-label":`Remove ${t.label}`,onclick:()=>i.call("remove",{key:t.key})},"\xD7"))}function cu({state:i,done:t,windows:e,problem:n,note:s,score:r}){return i==="done"?[`ADE ${r.ade.toFixed(3)} ${r.units}`,s].filter(Boolean).join("; "):i==="failed"?n:i==="waits"?"waits":`${i==="runs"?"running":i}: ${t} of ${e} frames`}function zR(i){let{degradation:t}=i.board,e=f("button",{type:"button",disabled:!i.recording,onclick:()=>sv(i)},"Degrade input\u2026");if(!t)return f("div",{class:"buttons"},e);let n=f("select",{"aria-label":"Input that is drawn"},[f("option",{value:"clean",selected:i.input==="clean"},"as recorded"),f("option",{value:"degraded",selected:i.input==="degraded"},"degraded")]);n.addEventListener("change",()=>i.setInput(n.value));let s=f("button",{type:"button",onclick:()=>i.call("degrade",{name:"",values:{}})},"As recorded only");return f("div",{},f("div",{class:"buttons"},e,s),f("p",{class:"hint"},`Input also: ${t.text}`),f("label",{class:"field"},f("span",{},"Drawn input"),n))}async function HR(i,t){let e=()=>i.board.predictors.find(c=>c.key===t),n=f("div",{}),s=()=>{let c=e();c&&pt(n,c.fit?GR(c.fit):f("p",{},"Each frame has its own fit; click a person to see it. Calibrate fits all frames and shows the spread over people."))};s();let r=()=>s();i.addEventListener("board",r);let o=async()=>{let c=await i.call("calibrate_line",{key:t});return c!==void 0&&await Cs(c),!1},a=async()=>(await i.call("calibrate",{key:t}),!1);we(`Parameters of ${e().label}`,n,[["Copy as command line",o],["Close",()=>!0],["Calibrate",a]]).addEventListener("close",()=>i.removeEventListener("board",r))}function GR(i){let t=r=>f("td",{class:"number"},r.toPrecision(4)),e=["parameter","median","sd over people","unit"].map(r=>f("th",{scope:"col"},r)),n=i.parameters.map(r=>f("tr",{},f("td",{},r.name),t(r.median),t(r.sd),f("td",{},r.unit))),s=`${i.scheme}: mean cost ${i.cost.toFixed(4)} m, ${i.given_cost.toFixed(4)} m before; ${i.persons} persons in ${i.windows} windows, ${i.evaluations} evaluations, ${i.seconds.toFixed(1)} s`;return f("table",{class:"fit"},f("caption",{},s),f("thead",{},f("tr",{},e)),f("tbody",{},n))}function lv(i,t){let e=f("div",{},f("p",{},"No recording is open.")),n=f("button",{type:"button",onclick:()=>XR(i),disabled:!0},"Time base, units\u2026"),s=f("button",{type:"button",onclick:()=>qR(i),disabled:!0},"Background\u2026"),r=f("section",{"aria-label":"Recording"},f("h2",{},"Recording"),f("div",{class:"buttons"},f("button",{type:"button",onclick:()=>fp(i)},"Open\u2026"),n,s),e,f("p",{class:"hint"},"Files may be dropped anywhere on this tab."));return i.on("board",()=>{let{recording:o}=i;n.disabled=s.disabled=!o,pt(e,o?f("dl",{class:"facts"},VR(o)):f("p",{},"No recording is open."))}),$R(i,t),r}function VR(i){let{summary:t}=i,e=[["File",i.file],["Format",`${i.format} (${i.about})`],["Time base",`${cl(i.fps)} frames/s, a row every ${i.frame_step===1?"frame":`${i.frame_step} frames`} = ${cl(i.dt)} s`],["Units",`${i.units}, mean speed ${cl(t.mean_speed)} ${i.units}/s, largest ${cl(t.max_speed)}`],["Content",`${t.tracks} tracks, ${t.rows} rows, ${cl(t.seconds)} s, ${av(i.robots,"robot")}, ${av(i.walls.length,"wall")}`],["Windows",`${i.windows} of ${i.observe} observed and ${i.predict} predicted rows, protocol ${i.protocol}`]];return i.note&&e.push(["Note",i.note]),e.flatMap(([n,s])=>[f("dt",{},n),f("dd",{},s)])}var av=(i,t)=>`${i} ${t}${i===1?"":"s"}`,cl=i=>i===null?"unknown":Number(i.toPrecision(4));async function fp(i){let t=await i.call("files");if(!t)return;let e=f("input",{type:"file","aria-label":"File of this computer"}),n=l=>async()=>await l()!==void 0&&a.close(),s=(l,c,h)=>f("li",{},f("button",{type:"button",onclick:n(h)},l),f("small",{},c)),r=t.files.map(l=>s(l.name,`${WR(l.bytes)}, ${new Date(l.changed*1e3).toLocaleString()}`,()=>i.call("open",{file:l.name}))),o=t.examples.map(l=>s(l.name,l.about,()=>i.call("example",{name:l.name})));e.addEventListener("change",n(()=>hv(i,e.files[0])));let a=we("Open a recording",[f("h3",{},"Example recordings"),f("ul",{class:"files"},o),f("h3",{},"From this computer"),e,f("h3",{},"Recent files"),r.length?f("ul",{class:"files"},r):f("p",{},"The folder of the session has no files yet.")],[["Close",()=>!0]])}var WR=i=>i<1e6?`${Math.ceil(i/1e3)} kB`:`${(i/1e6).toFixed(1)} MB`;async function cv(i,t){let e=`api/${i.app.connection.session}/upload?${new URLSearchParams({name:t.name})}`,n=await fetch(e,{method:"POST",body:t}).catch(s=>({ok:!1,text:()=>s.message}));if(n.ok)return(await n.json()).name;me(`${t.name}: ${(await n.text()).trim()}`,"error")}async function hv(i,t){let e=t&&await cv(i,t);return e&&i.call("open",{file:e})}function $R(i,t){t.addEventListener("dragover",e=>{e.preventDefault(),t.classList.add("dropping")}),t.addEventListener("dragleave",()=>t.classList.remove("dropping")),t.addEventListener("drop",e=>{e.preventDefault(),t.classList.remove("dropping");let[n]=e.dataTransfer.files;n&&hv(i,n)})}function XR(i){let{options:t,file:e,format:n}=i.recording,s=d=>d.map(u=>[u.name,`${u.name}: ${u.about}`]),{formats:r,protocols:o,time_bases:a}=i.tables,l=dn([{name:"format",label:"Format",kind:"choice",value:t.format??"",choices:[["",`found in the content: ${n}`],...s(r)]},{name:"fps",label:"Frames per second of the frame counter",unit:"1/s",kind:"number",value:t.fps,low:0,note:"empty: from the file"},{name:"time_base",label:"Time base of the ETH recording",kind:"choice",value:t.time_base,choices:s(a)},{name:"units",label:"Units of the coordinates in the file",kind:"choice",value:t.units??"",choices:[["","from the file"],"m","cm","mm","px"]},{name:"step",label:"Time step after resampling",unit:"s",kind:"number",value:t.step,low:0,note:"empty: the step of the file"},{name:"observe",label:"Observed rows",kind:"whole",value:t.observe,low:1},{name:"predict",label:"Predicted rows",kind:"whole",value:t.predict,low:1},{name:"protocol",label:"Protocol",kind:"choice",value:t.protocol,choices:s(o)},{name:"every",label:"Use every n-th window",kind:"whole",value:t.every,low:1},{name:"learn",label:"Share of the recording for learning goals",kind:"number",value:t.learn,low:0,high:.99},{name:"near",label:"Score only people this near to a robot",unit:"m",kind:"number",value:t.near,low:0,note:"empty: everybody"},{name:"late",label:"People who appear during the observation",kind:"choice",value:t.late,choices:["skip","extrapolate"]}]),c=i.recording.path,h=async()=>await i.call("open",{file:c,options:l.values()})!==void 0;we(`Time base and units of ${e}`,l.element,[["Cancel",()=>!0],["Load",h]])}function qR(i){let t=f("input",{type:"file",accept:"image/*","aria-label":"Picture"}),e=dn([{name:"homography",label:"Homography from (column, row, 1) to the tracks",kind:"text",value:"",note:"nine numbers by rows, or one: metres per pixel; empty: that of the recording"}]),n=async()=>{let[s]=t.files;if(!s)return me("choose a picture first","error"),!1;let r=await cv(i,s);return r!==void 0&&await i.call("background",{file:r,...e.values()})!==void 0};we("Background picture",[f("label",{class:"field"},f("span",{},"Picture of the ground, from above or from a fixed camera"),t),e.element],[["Cancel",()=>!0],["Show",n]])}function uv(i){let t=f("div",{class:"table-place",tabindex:0,role:"region","aria-label":"Table of metrics"});return i.on("results",({table:e})=>pt(t,e.rows.length?YR(e):f("p",{class:"hint"},"No results yet: add a predictor and press Run."))),pt(t,f("p",{class:"hint"},"No results yet: add a predictor and press Run.")),f("section",{"aria-label":"Metrics",class:"metrics"},f("h2",{},"Metrics"),t)}function YR({heads:i,rows:t,caption:e,unit:n}){let s=t.some(l=>l.difference!==null),r=l=>f("th",{scope:"col",class:"number"},l),o=f("tr",{},f("th",{scope:"col"},"predictor"),i.map(r),s&&r(`ADE minus as recorded [${n}]`)),a=t.map(l=>f("tr",{"data-key":l.key,"data-input":l.input},f("th",{scope:"row"},hu(l.slot,l.input)," ",l.label,l.input==="degraded"?" (degraded)":"",l.note&&f("small",{},` ${l.note}`)),l.cells.map(c=>f("td",{class:"number"},c)),s&&f("td",{class:"number"},l.difference===null?"-":`${l.difference>0?"+":""}${l.difference.toFixed(3)}`)));return f("table",{},f("caption",{},e),f("thead",{},o),f("tbody",{},a))}function dv(i){let t=f("div",{"aria-live":"polite"}),e=0;async function n(){let r=++e;if(i.person===null||!i.recording){pt(t,f("p",{class:"hint"},"Click a person in the scene, or press n."));return}if(!i.frame?.people.some(a=>a.id===i.person)){pt(t,f("p",{},`Person ${i.person} is not in this frame.`));return}let o=await i.call("person",{index:i.index,id:i.person});o&&r===e&&pt(t,ZR(i,o))}let s=null;return i.on("frame person ended",()=>{s??=setTimeout(()=>{s=null,n()},60)}),n(),f("section",{"aria-label":"Person"},f("h2",{},"Person"),t)}var hl=(i,t=3)=>i===null?"-":Number(i).toFixed(t);function ZR(i,t){let{units:e}=i.recording,n=t.robot?"Robot":"Person",s=t.scored?"scored":"not scored, since their future is not known for all rows",r=`${n} ${t.id} at (${t.place.map(u=>u.toFixed(2)).join(", ")}) ${e}, ${hl(t.speed,2)} ${e}/s, ${t.rows} observed rows, ${s}`,o=u=>[u.ade,u.fde,u.mean_ade].map(p=>f("td",{class:"number"},hl(p))),a=u=>f("th",{scope:"row"},hu(u.slot,u.input)," ",u.label,u.input==="degraded"?" (degraded)":""),l=["predictor",`ADE [${e}]`,`FDE [${e}]`,"mean ADE"].map((u,p)=>f("th",{scope:"col",class:p?"number":""},u)),c=t.results.length&&f("table",{class:"person-errors"},f("caption",{},"Errors in this frame, and over all frames of this person"),f("thead",{},f("tr",{},l)),f("tbody",{},t.results.map(u=>f("tr",{},a(u),o(u))))),h=(u,p)=>f("button",{type:"button",onclick:()=>i.emit("plot",{variable:u,person:t.id})},p),d=t.results.filter(u=>u.parameters.length).map(u=>KR(u));return[f("p",{},r),c||null,f("div",{class:"buttons"},h("ade","Plot the error of this person")),...d]}function KR(i){let t=["parameter","fit","before","unit"].map((n,s)=>f("th",{scope:"col",class:s===1||s===2?"number":""},n)),e=i.parameters.map(n=>f("tr",{},f("th",{scope:"row"},n.name.replaceAll("_"," ")),f("td",{class:"number"},hl(n.value)),f("td",{class:"number"},hl(n.given)),f("td",{},n.unit)));return f("table",{class:"fit"},f("caption",{},`${i.label}: fit of this frame, cost ${hl(i.cost,4)} m`),f("thead",{},f("tr",{},t)),f("tbody",{},e))}var JR=600,jR=" frame people cost [m]  iter. time [ms] error [m]";function pv(i){let t=dn([{name:"seed",label:"Seed",kind:"whole",value:0,low:0},{name:"live",label:"Each fit starts from the frame before (live)",kind:"switch",value:!1}]),e=f("input",{type:"checkbox",checked:!0}),n=f("button",{type:"button",class:"main",disabled:!0,onclick:()=>u()},"Run"),s=f("button",{type:"button",disabled:!0,onclick:()=>i.call("cancel")},"Cancel"),r=f("progress",{max:1,value:0,"aria-label":"Progress of the run"}),o=f("span",{role:"status",class:"hint"},""),a=f("pre",{}),l=f("div",{class:"log",tabindex:0,role:"region","aria-label":"Log, one line a frame"},f("pre",{class:"head"},jR),a),c=[],h="",d=0;async function u(){let{seed:g,live:_}=t.values();await i.call("run",{seed:g??0,live:_})}function p({active:g,share:_}){n.disabled=g||!i.recording||!i.board.predictors.length,s.disabled=!g,r.value=_}function m(g,_){g!==h&&_.length&&c.push(g),h=_.length?g:h,c=[...c,..._.map(QR)].slice(-JR),a.textContent=c.join(`
`),l.scrollTop=l.scrollHeight}let x=f("p",{class:"hint"});return i.on("board",()=>{p(i.board.run),x.hidden=!!(i.recording&&i.board.predictors.length),x.textContent=i.recording?"Add a predictor to run it.":"Open a recording and add a predictor to run it."}),i.on("log",g=>{c=[],h="";for(let{key:_,input:b,lines:S}of g)m(fv(i,_,b),S)}),i.on("lines",({key:g,input:_,lines:b})=>{m(fv(i,g,_),b),e.checked&&b.length&&i.go(i.recording.frames.indexOf(b.at(-1)[0]))}),i.on("progress",({share:g})=>{p({active:!0,share:g}),Date.now()-d>1500&&(d=Date.now(),pt(o,`${Math.round(100*g)} % done`))}),i.on("ended",({problem:g,cancelled:_})=>{pt(o,g||(_?"cancelled; results so far are kept":"done")),g&&me(g,"error")}),f("section",{"aria-label":"Run"},f("h2",{},"Run"),t.element,f("div",{class:"buttons"},n,s,f("label",{},e,"show the newest frame")),x,r,o,l)}function fv(i,t,e){return`${i.board.predictors.find(s=>s.key===t)?.label??t}${e==="degraded"?" (degraded)":""}`}function QR([i,t,e,n,s,r]){let o=(l,c,h)=>(l===null?"-":l.toFixed(c)).padStart(h),a=(l,c)=>String(l).padStart(c);return`${a(i,6)} ${a(t,6)} ${o(e,5,8)} ${a(n,6)} ${o(1e3*s,2,9)} ${o(r,3,9)}`}var tC=.25,ul=.15;function pp(i,{recording:t,frame:e,layers:n,selected:s,background:r,input:o}){let a=wn("--ink"),l=wn("--faint");if(r&&n.background&&i.picture(r,t.background.bounds),oC(i,t,l),n.walls)for(let c of t.walls)i.line(c,{colour:a,width:2,closed:!0});if(e){if(n.predicted&&n.density)for(let c of e.forecasts)sC(i,c,s);for(let c of e.people)n.observed&&i.line(c.past,{colour:l,width:1.5}),n.truth&&eC(i,c,a);if(e.seen&&n.seen&&o==="degraded")for(let c of e.seen)nC(i,c,wn("--data-5"));if(n.predicted&&!n.density)for(let c of e.forecasts)iC(i,c,e,s,o);rC(i,e,n,s,{ink:a,faint:l})}}function eC(i,t,e){t.truth.length&&(i.line([t.now,...t.truth],{colour:e,width:1.2,dash:[1,3]}),i.square(t.truth.at(-1),2.5,{stroke:e}))}function nC(i,t,e){i.line(t,{colour:e,width:1,dash:[1,2]});for(let n of t)i.square(n,1.2,{fill:e})}function iC(i,{slot:t,paths:e},n,s,r){let o=dp(t),{dash:a}=Or(t),l=Math.max(...e.map(h=>h.weight)),c=new Map(n.people.map(h=>[h.id,h.now]));for(let{weight:h,people:d}of e){if(h<=0)continue;let u=e.length>1?.35+.5*h/l:1;for(let{id:p,points:m}of d){let x=s===null||s===p?u:.35*u,g=r==="clean"?c.get(p):null;i.line(g?[g,...m]:m,{colour:o,width:e.length>1?1:2,dash:a,opacity:x}),e.length===1&&i.disc(m.at(-1),2.5,{fill:o,opacity:x})}}}function sC(i,{slot:t,paths:e},n){let s=new Map;for(let{weight:l,people:c}of e)for(let{id:h,points:d}of c)if(!(n!==null&&n!==h))for(let[u,p]of d){let m=`${Math.floor(u/ul)} ${Math.floor(p/ul)}`;s.set(m,(s.get(m)??0)+l)}let r=Math.max(1e-9,...s.values()),o=.5*ul*i.view.scale+.5,a=dp(t);for(let[l,c]of s){let[h,d]=l.split(" ").map(Number);i.square([(h+.5)*ul,(d+.5)*ul],o,{fill:a,opacity:.1+.7*Math.sqrt(c/r)})}}function rC(i,t,e,n,{ink:s,faint:r}){let o=Math.max(3,Math.min(14,tC*i.view.scale));for(let a of t.people){let l=a.id===n,c={fill:a.scored?wn("--person"):wn("--panel"),stroke:l?wn("--focus"):s,width:l?3:1};a.robot?i.square(a.now,o,{...c,fill:wn("--robot")}):i.disc(a.now,l?o+1.5:o,c),(e.ids||l)&&i.text(a.now,String(a.id),{colour:e.ids?s:r,dx:o+3,dy:-o})}}function oC(i,t,e){let n=i.view.width/i.view.scale,s=10**Math.floor(Math.log10(n/3)),r=i.view.place(14,i.view.height-14),o=[r[0]+s,r[1]];i.line([r,o],{colour:e,width:2}),i.text(r,`${s} ${t.units}`,{colour:e,dy:-6})}var uu=class{constructor(){Object.assign(this,{x:0,y:0,scale:40,width:600,height:400,down:!1})}fit([t,e,n,s]){this.x=(t+n)/2,this.y=(e+s)/2,this.scale=Math.min(this.width/(n-t),this.height/(s-e))}at([t,e]){let n=this.down?1:-1;return[this.width/2+(t-this.x)*this.scale,this.height/2+n*(e-this.y)*this.scale]}place(t,e){let n=this.down?1:-1;return[this.x+(t-this.width/2)/this.scale,this.y+n*(e-this.height/2)/this.scale]}zoom(t,e=this.width/2,n=this.height/2){let s=this.place(e,n);this.scale=Math.max(.01,Math.min(4e3,this.scale*t));let r=this.place(e,n);this.x+=s[0]-r[0],this.y+=s[1]-r[1]}},du=class{constructor(t,e){this.context=t,this.view=e}line(t,{colour:e,width:n=1,dash:s=[],opacity:r=1,closed:o=!1}){if(t.length<2)return;let a=this.context;a.beginPath(),t.forEach((l,c)=>a[c?"lineTo":"moveTo"](...this.view.at(l))),o&&a.closePath(),a.globalAlpha=r,a.strokeStyle=e,a.lineWidth=n,a.setLineDash(s),a.stroke(),a.globalAlpha=1}disc(t,e,{fill:n=null,stroke:s=null,width:r=1,opacity:o=1}){let a=this.context;a.beginPath(),a.arc(...this.view.at(t),e,0,2*Math.PI),this._finish(n,s,r,o)}square(t,e,{fill:n=null,stroke:s=null,width:r=1,opacity:o=1}){let[a,l]=this.view.at(t);this.context.beginPath(),this.context.rect(a-e,l-e,2*e,2*e),this._finish(n,s,r,o)}text(t,e,{colour:n,dx:s=0,dy:r=0}){let[o,a]=this.view.at(t);this.context.font="11px system-ui, sans-serif",this.context.fillStyle=n,this.context.fillText(e,o+s,a+r)}picture(t,[e,n,s,r]){let[o,a]=this.view.at([e,this.view.down?n:r]),{scale:l}=this.view;this.view.down?(this.context.save(),this.context.translate(o,a+(r-n)*l),this.context.scale(1,-1),this.context.drawImage(t,0,0,(s-e)*l,(r-n)*l),this.context.restore()):this.context.drawImage(t,o,a,(s-e)*l,(r-n)*l)}_finish(t,e,n,s){let r=this.context;r.globalAlpha=s,r.setLineDash([]),t&&(r.fillStyle=t,r.fill()),e&&(r.strokeStyle=e,r.lineWidth=n,r.stroke()),r.globalAlpha=1}},fu=class{constructor(t,e){this.view=t,this.parts=[`<rect width="${t.width}" height="${t.height}" fill="${e}"/>`]}line(t,{colour:e,width:n=1,dash:s=[],opacity:r=1,closed:o=!1}){if(t.length<2)return;let a=t.map(h=>this.view.at(h).map(ss).join(",")).join(" "),l=s.length?` stroke-dasharray="${s.join(" ")}"`:"",c=o?"polygon":"polyline";this.parts.push(`<${c} points="${a}" fill="none" stroke="${e}" stroke-width="${n}"${l}${gv(r)}/>`)}disc(t,e,n){let[s,r]=this.view.at(t).map(ss);this.parts.push(`<circle cx="${s}" cy="${r}" r="${ss(e)}"${mv(n)}/>`)}square(t,e,n){let[s,r]=this.view.at(t);this.parts.push(`<rect x="${ss(s-e)}" y="${ss(r-e)}" width="${ss(2*e)}" height="${ss(2*e)}"${mv(n)}/>`)}text(t,e,{colour:n,dx:s=0,dy:r=0}){let[o,a]=this.view.at(t),l=e.replace(/[&<>"]/g,c=>`&#${c.charCodeAt(0)};`);this.parts.push(`<text x="${ss(o+s)}" y="${ss(a+r)}" fill="${n}" font-size="11" font-family="sans-serif">${l}</text>`)}picture(){}toString(){let{width:t,height:e}=this.view;return`<svg xmlns="http://www.w3.org/2000/svg" width="${t}" height="${e}" viewBox="0 0 ${t} ${e}">
${this.parts.join(`
`)}
</svg>
`}},ss=i=>Math.round(i*100)/100,gv=i=>i===1?"":` opacity="${ss(i)}"`;function mv({fill:i=null,stroke:t=null,width:e=1,opacity:n=1}){let s=t?` stroke="${t}" stroke-width="${e}"`:"";return` fill="${i??"none"}"${s}${gv(n)}`}var aC=18,pu=class{constructor(t){this.store=t,this.view=new uu,this.background=null,this.canvas=f("canvas",{tabindex:0,role:"img","aria-label":"Scene",class:"scene"}),this.summary=f("p",{class:"summary","aria-live":"polite"},""),this.element=f("div",{class:"scene-place"},this.canvas),new ResizeObserver(()=>this._resize()).observe(this.element),t.on("board",e=>this._board(e)),t.on("frame person view",()=>this.draw()),t.on("frame",()=>this._tell()),document.addEventListener("theme",()=>this.draw()),this._listen()}fit(){this.store.recording&&(this.view.fit(this.store.recording.bounds),this.draw())}draw(){this._waits??=requestAnimationFrame(()=>{this._waits=null,this._draw()})}png(){return this._draw(),new Promise(t=>this.canvas.toBlob(t,"image/png"))}svg(){let t=new fu(this.view,wn("--paper"));return pp(t,this._content()),t.toString()}pick(t,e){let n=null,s=aC;for(let r of this.store.frame?.people??[]){let[o,a]=this.view.at(r.now),l=Math.hypot(o-t,a-e);l<s&&([n,s]=[r.id,l])}return n}step(t){let e=(this.store.frame?.people??[]).map(s=>s.id);if(!e.length)return;let n=e.indexOf(this.store.person);this.store.choose(e[n<0?0:(n+t+e.length)%e.length])}_content(){let{recording:t,frame:e,layers:n,person:s,input:r}=this.store;return{recording:t,frame:e,layers:n,selected:s,background:this.background,input:r}}_draw(){let t=devicePixelRatio||1,e=this.canvas.getContext("2d");e.setTransform(t,0,0,t,0,0),e.fillStyle=wn("--paper"),e.fillRect(0,0,this.view.width,this.view.height),this.store.recording&&pp(new du(e,this.view),this._content()),this.canvas.dataset.frame=this.store.frame?.index??"",this.canvas.dataset.forecasts=this.store.frame?.forecasts.length??0}_resize(){let{clientWidth:t,clientHeight:e}=this.element;if(!t||!e)return;let n=devicePixelRatio||1,s=this.view.width===600&&this.view.height===400;Object.assign(this.view,{width:t,height:e}),this.canvas.width=t*n,this.canvas.height=e*n,(s||!this._moved)&&this.fit(),this._draw()}_board(t){let{recording:e}=this.store;this.view.down=e?.units==="px";let n=JSON.stringify(e?.background??null);n!==this._backgroundName&&this._loadBackground(n),t&&(this._moved=!1,this.fit()),this.draw()}_loadBackground(t){if(this._backgroundName=t,this.background=null,t==="null")return;let e=new Image;e.onload=()=>{this.background=e,this._moved=!1,this.fit()},e.src=this.store.app.connection.address("prediction","background.png",{name:t})}_tell(){let{frame:t,recording:e}=this.store,n=t.people.filter(o=>o.scored).length,s=t.people.filter(o=>o.robot).length,r=`Frame ${e.frames[t.index]}, ${t.time.toFixed(2)} s: ${t.people.length-s} people, ${s} ${s===1?"robot":"robots"}, ${n} scored, ${t.forecasts.length} ${t.forecasts.length===1?"predictor":"predictors"}`;this.canvas.setAttribute("aria-label",`Scene. ${r}`),clearTimeout(this._later),this._later=setTimeout(()=>pt(this.summary,r),400)}_listen(){let t=null,e=!1;this.canvas.addEventListener("pointerdown",n=>{t=[n.offsetX,n.offsetY],e=!1,this.canvas.setPointerCapture(n.pointerId)}),this.canvas.addEventListener("pointermove",n=>{if(!t)return;let[s,r]=[n.offsetX-t[0],n.offsetY-t[1]];!e&&Math.hypot(s,r)<4||(e=this._moved=!0,this._shift(-s,-r),t=[n.offsetX,n.offsetY])}),this.canvas.addEventListener("pointerup",n=>{t&&!e&&this.store.choose(this.pick(n.offsetX,n.offsetY)),t=null}),this.canvas.addEventListener("wheel",n=>{n.preventDefault(),this._moved=!0,this.view.zoom(Math.exp(-n.deltaY*.0015),n.offsetX,n.offsetY),this.draw()},{passive:!1})}_shift(t,e){this.view.x+=t/this.view.scale,this.view.y+=(this.view.down?1:-1)*e/this.view.scale,this.draw()}zoom(t){this._moved=!0,this.view.zoom(t),this.draw()}};var lC={frame:"index",person:"person"},mu=class extends EventTarget{constructor(t){super(),this.app=t,this.board={recording:null,predictors:[],degradation:null,run:{active:!1,share:0}},this.tables=null,this.index=0,this.person=null,this.frame=null,this.hidden=new Set,this.layers={walls:!0,background:!0,observed:!0,truth:!0,predicted:!0,ids:!1,density:!1,seen:!0},this.input="clean",this._loading=null;for(let[e,n]of Object.entries(lC)){let s=t.address.get(e);/^\d+$/.test(s??"")&&(this[n]=Number(s))}}call(t,e={}){return he(()=>this.app.connection.call(`prediction.${t}`,e))}get recording(){return this.board.recording}take(t){let e=this.recording;this.board=t;let n=t.recording,s=e?.file!==n?.file||JSON.stringify(e?.options)!==JSON.stringify(n?.options);t.degradation||(this.input="clean"),n&&(this.index=Math.min(this.index,n.windows-1)),s&&e&&(this.index=0,this.person=null),this.emit("board",s),n&&this.load()}go(t){return this.recording?(this.index=Math.max(0,Math.min(this.recording.windows-1,Math.round(t))),this.app.remember({frame:this.index}),this.emit("index"),this.load()):Promise.resolve()}choose(t){this.person=t,this.app.remember({person:t}),this.emit("person")}show(t,e){this.layers[t]=e,this.emit("view")}setInput(t){this.input=t,this.load(),this.emit("view")}hide(t,e){e?this.hidden.add(t):this.hidden.delete(t),this.load()}load(){return this._wanted=!0,this._loading??=this._fetch().finally(()=>this._loading=null),this._loading}async _fetch(){for(;this._wanted;){this._wanted=!1;let t=this.index,e={index:t,input:this.input,hide:[...this.hidden].join(",")},n=await fetch(this.app.connection.address("prediction","window",e)).catch(()=>null);if(!n?.ok)return;this.frame=cC(Fs(await n.arrayBuffer()),this.recording,t),this.emit("frame")}}emit(t,e){this.dispatchEvent(new CustomEvent(t,{detail:e}))}on(t,e){for(let n of t.split(" "))this.addEventListener(n,s=>e(s.detail))}};function cC({arrays:i,time:t},e,n){let s=[...i.ids].map((a,l)=>({id:a,robot:(i.kind[l]&1)===1,scored:(i.kind[l]&2)===2,past:mp(i.past,l*e.observe,e.observe),truth:mp(i.truth,l*e.predict,e.predict)}));for(let a of s)a.now=a.past.at(-1);let r=Object.keys(i).filter(a=>a.startsWith("path.")).map(a=>hC(Number(a.slice(5)),i,e.predict)),o=i.seen?uC(i.seen,e.observe):null;return{index:n,time:t,people:s,forecasts:r,seen:o}}function hC(i,t,e){let n=[...t[`ids.${i}`]],s=[...t[`mass.${i}`]],r=t[`path.${i}`],o=s.map((a,l)=>({weight:a,people:n.map((c,h)=>({id:c,points:Array.from({length:e},(d,u)=>{let p=2*((l*e+u)*n.length+h);return[r[p],r[p+1]]})}))}));return{slot:i,ids:n,paths:o}}function uC(i,t){return Array.from({length:i.length/2/t},(e,n)=>mp(i,n*t,t))}function mp(i,t,e){let n=[];for(let s=t;s<t+e;s++)Number.isFinite(i[2*s])&&n.push([i[2*s],i[2*s+1]]);return n}var dC=[["observed","Observed"],["truth","True"],["predicted","Predicted"],["density","Density"],["walls","Walls"],["background","Ground"],["ids","Numbers"]];function vv(i,t){let e=dC.map(([s,r])=>{let o=f("input",{type:"checkbox",checked:i.layers[s]});return o.addEventListener("change",()=>i.show(s,o.checked)),f("label",{},o,r)}),n=f("select",{"aria-label":"Export or copy"},[f("option",{value:""},"Export or copy\u2026"),..._v(i,t).map(([s,r])=>f("option",{value:s},r))]);return n.addEventListener("change",()=>{let s=_v(i,t).find(([r])=>r===n.value);n.value="",i.recording?s?.[2]():me("open a recording first","error")}),f("div",{class:"toolbar",role:"group","aria-label":"Scene"},f("span",{class:"layers"},e),f("button",{type:"button",onclick:()=>t.fit()},"Fit"),f("button",{type:"button","aria-label":"Zoom in",onclick:()=>t.zoom(1.25)},"+"),f("button",{type:"button","aria-label":"Zoom out",onclick:()=>t.zoom(.8)},"\u2212"),n)}function _v(i,t){let e=()=>`${i.recording.file}-${i.recording.frames[i.index]}`;return[["command","Copy as command line",()=>yv(i,"command_line")],["python","Copy as Python",()=>yv(i,"python")],["png","Scene as PNG",async()=>gp(await t.png(),`${e()}.png`)],["svg","Scene as SVG",()=>gp(new Blob([t.svg()],{type:"image/svg+xml"}),`${e()}.svg`)],["mp4","This frame as video (MP4)",()=>dl(i,"animation.mp4",{index:i.index})],["gif","This frame as animation (GIF)",()=>dl(i,"animation.gif",{index:i.index})],["frames.csv","Results by frame as CSV",()=>dl(i,"frames.csv")],["people.csv","Results by person as CSV",()=>dl(i,"people.csv")],["frames.parquet","Results by frame as Parquet",()=>dl(i,"frames.parquet")]]}async function yv(i,t){let e=i.input==="degraded",n=await i.call(t,{degraded:e});n!==void 0&&await Cs(n,t==="python"?"Copy as Python":"Copy as command line")}async function dl(i,t,e={}){let n=await fetch(i.app.connection.address("prediction",t,e)).catch(r=>({ok:!1,text:()=>r.message}));if(!n.ok)return me((await n.text()).trim(),"error");let s=/filename="([^"]+)"/.exec(n.headers.get("Content-Disposition")??"")?.[1]??t;return gp(await n.blob(),s)}function gp(i,t){let e=f("a",{href:URL.createObjectURL(i),download:t});e.click(),setTimeout(()=>URL.revokeObjectURL(e.href),1e4)}var fC=[.25,.5,1,2,4,8],gu=class{constructor(t){this.store=t,this.playing=!1,this.speed=f("select",{"aria-label":"Speed"},fC.map(e=>f("option",{value:e,selected:e===1},`${e}\xD7`))),this.slider=f("input",{type:"range",min:0,max:0,value:0,"aria-label":"Frame",oninput:()=>t.go(Number(this.slider.value))}),this.button=this._button("Play",()=>this.toggle()),this.jump=f("input",{type:"number","aria-label":"Jump to frame",step:1,onchange:()=>this.jumpTo(Number(this.jump.value))}),this.words=f("span",{class:"position"},""),this.element=f("div",{class:"transport",role:"group","aria-label":"Playback"},this._button("First",()=>t.go(0)),this._button("Back",()=>this.step(-1)),this.button,this._button("Step",()=>this.step(1)),this._button("Last",()=>t.go(1/0)),this.slider,this.words,f("label",{},"Jump to",this.jump),this.speed),t.on("board index frame",()=>this._update())}step(t){return this.pause(),this.store.go(this.store.index+t)}jumpTo(t){let e=this.store.recording?.frames??[],n=0;return e.forEach((s,r)=>{Math.abs(s-t)<Math.abs(e[n]-t)&&(n=r)}),this.store.go(n)}toggle(){this.playing?this.pause():this.play()}pause(){this.playing=!1,clearTimeout(this._timer),pt(this.button,"Play")}async play(){let{store:t}=this;t.recording&&(this.playing=!0,pt(this.button,"Pause"),t.index>=t.recording.windows-1&&await t.go(0),this._next())}_next(){let{frames:t,fps:e}=this.store.recording,n=(t[this.store.index+1]-t[this.store.index])/e,s=1e3*Math.min(2,n||0)/Number(this.speed.value);this._timer=setTimeout(async()=>{this.playing&&(await this.store.go(this.store.index+1),this.store.index>=this.store.recording.windows-1?this.pause():this.playing&&this._next())},s)}_update(){let{recording:t,index:e}=this.store,n=!t;for(let r of this.element.querySelectorAll("button, input, select"))r.disabled=n;if(n)return;this.slider.max=t.windows-1,this.slider.value=e,this.slider.setAttribute("aria-valuetext",`frame ${t.frames[e]}`);let s=(t.frames[e]-t.frames[0])/t.fps;pt(this.words,`frame ${t.frames[e]}, ${s.toFixed(2)} s, ${e+1} of ${t.windows}`)}_button(t,e){return f("button",{type:"button",onclick:e},t)}};function xv(i){let t=f("div",{class:"buttons"}),e=f("section",{class:"welcome","aria-label":"First steps",hidden:!0},f("h2",{},"Predict where people walk"),f("ol",{},f("li",{},"Open a recording of people, or start with an example."),f("li",{},"Add predictors: a crowd model that is calibrated in each frame, a baseline, or a learned one."),f("li",{},"Run them, and compare their paths and errors with the true future.")),f("div",{class:"buttons"},f("button",{type:"button",class:"main",onclick:()=>fp(i)},"Choose a recording\u2026")),t),n=!1;return i.on("board",async()=>{if(e.hidden=!!i.recording,n||i.recording)return;n=!0;let r=((await i.call("files"))?.examples??[]).map(({name:o,about:a})=>f("button",{type:"button",title:a,onclick:()=>i.call("example",{name:o})},`Example: ${o}`));pt(t,r)}),e}var bv={name:"prediction",title:"Prediction",mount(i,t){let e=new mu(t),n=new pu(e),s=new gu(e);return n.element.append(xv(e)),i.classList.add("prediction"),i.append(f("div",{class:"side"},lv(e,i),ov(e),pv(e)),f("div",{class:"middle"},vv(e,n),n.element,n.summary,s.element,uv(e)),f("div",{class:"side"},dv(e),tv(e))),gC(t,e,n,s),mC(t,e),{store:e,scene:n,hide:()=>s.pause(),show:()=>n.draw(),greet:r=>pC(e,r)}}};async function pC(i,t){i.tables??=await i.call("tables"),i.take(t.stored?await i.call("restore")??t:t);let e=await i.call("log");e&&i.emit("log",e)}function mC(i,t){i.connection.on("prediction.board",e=>t.take(e));for(let e of["lines","progress","ended","note"])i.connection.on(`prediction.${e}`,n=>{e==="progress"&&(t.board.run={active:!0,share:n.share}),t.emit(e,n),(e==="lines"||e==="ended")&&t.load()})}function gC(i,t,e,n){i.keys.add("prediction",[[" ","Play or pause",()=>n.toggle()],["ArrowRight","Next frame",()=>n.step(1)],["ArrowLeft","Previous frame",()=>n.step(-1)],["Home","First frame",()=>t.go(0)],["End","Last frame",()=>t.go(1/0)],["n","Next person",()=>e.step(1)],["p","Previous person",()=>e.step(-1)],["Escape","No person",()=>t.choose(null)],["f","Fit the scene",()=>e.fit()],["+","Zoom in",()=>e.zoom(1.25)],["-","Zoom out",()=>e.zoom(.8)]])}var _p={person:"Room of the person",robot:"Room of the robot"},kr=(i,t=3)=>i==null?"\u2013":i.toFixed(t);function yp(i,t){let e=(S,y={})=>t._call(S,{room:i,...y}),n=S=>f("input",{type:"number",step:"any",value:0,"aria-label":`${_p[i]}: ${S}`}),s={x:n("x [m]"),y:n("y [m]"),heading:n("heading [deg]")},r=["x","y","z"].map(S=>n(`${S} in the room [m]`)),o=["x","y","z"].map(S=>n(`${S} in the virtual room [m]`)),a=f("input",{type:"text",placeholder:"0,0 4,0 4,3 0,3"}),l=S=>S.map(y=>Number(y.value)),c=f("p",{role:"status"}),h=f("tbody"),d=null,u=()=>{if(i==="robot")return e("add_pair",{source:l(r),target:l(o)});let[S,y,C]=l(o);return t._call("add_wrist_pair",{avatar:d??"",x:S,y,z:C})},p=()=>{let[S,y,C]=l(Object.values(s));return e("place_room",{x:S,y,heading:C*Math.PI/180})},m=()=>{let S=a.value.trim().split(/\s+/).filter(Boolean);return e("limit_room",{corners:S.map(y=>y.split(",").map(Number))})},x=(S,y)=>f("button",{type:"button",onclick:y},S),g=(S,y)=>f("fieldset",{class:"vr-line"},f("legend",{},S),y),_=f("section",{"aria-label":_p[i]},f("h2",{},_p[i]),g("Origin x, y [m] and heading [deg]",Object.values(s)),x("Set place",p),f("h3",{},"Calibration"),i==="robot"?g("Point in the room x, y, z [m]",r):f("p",{},"Touch a known point with the right wrist, then add it."),g("The same point in the virtual room x, y, z [m]",o),f("div",{class:"vr-buttons"},x(i==="robot"?"Add point":"Add touched point",u),x("Calibrate",()=>e("calibrate")),x("Clear points",()=>e("clear_points"))),f("table",{class:"vr-points"},f("thead",{},f("tr",{},["Room x, y, z [m]","Virtual x, y, z [m]","Residual [m]"].map(S=>f("th",{scope:"col"},S)))),h),c,f("h3",{},"Limits"),en("Corners of the free floor x,y [m]",a),x("Set limits",m));return{element:_,take:(S,y)=>{d=y[0]?.avatar??null,_.contains(document.activeElement)||(s.x.value=kr(S.x),s.y.value=kr(S.y),s.heading.value=kr(S.heading*180/Math.PI,1),a.value=S.limits.map(E=>E.join(",")).join(" "));let C=E=>E.map(v=>kr(v)).join(", ");pt(h,S.source.map((E,v)=>f("tr",{},[C(E),C(S.target[v]),kr(S.residual[v])].map(T=>f("td",{},T))))),c.textContent=S.rms===null?"Not calibrated.":`Residual ${kr(S.rms)} m (root mean square), noise of a point ${kr(S.noise)} m.`}}}var wv=[{name:"motion_delay",label:"Added delay of motion",unit:"ms",factor:1e3},{name:"picture_delay",label:"Added delay of the picture",unit:"ms",factor:1e3},{name:"noise",label:"Added noise of positions",unit:"mm",factor:1e3},{name:"buffer",label:"Age of poses that are used",unit:"ms",factor:1e3},{name:"timeout",label:"Tracking is lost after",unit:"s",factor:1}],Sv=["Participant","Motion to simulation","State to picture","Round trip","Clock offset","Lost","Dropped","Limits","Tracking",""],Mv=(i,t)=>i===null?"\u2013":`${i.toFixed(1)} ms (p95 ${t.toFixed(1)})`,Ev={name:"vr",title:"VR",mount:(i,t)=>new vp(i,t)},vp=class{constructor(t,e){this.app=e,this.state=null,this.root=t,t.classList.add("vr-tab"),this._layout(),e.connection.on("vr.state",n=>this._take(n)),e.connection.on("vr.problem",n=>me(n,"error")),e.connection.on("vr.measured",n=>this._tellMeasure(n))}greet(t){this.known=!!t?.settings,this.main.hidden=!this.known,this.none.hidden=this.known,this.known&&this._take(t)}show(){this.known&&this._call("state").then(t=>t&&this._take(t))}_call(t,e={}){return he(()=>this.app.connection.call(`vr.${t}`,e))}_layout(){let t=(s,r,o="")=>f("button",{type:"button",class:o,onclick:()=>this._call(r)},s),e=(s,r)=>{let o=f("input",{type:"checkbox",onchange:()=>this._call("show",{[s]:o.checked})});return[s,f("label",{class:"vr-switch"},o,r),o]};this.switches=[e("mirror","Virtual mirror"),e("own_body","Participants see their own body")],this.rows=f("tbody"),this.warnings=f("p",{class:"vr-warnings",role:"status"}),this.link=f("a",{target:"_blank",rel:"noopener",class:"vr-enter"},"Enter VR"),this.words=f("code",{class:"vr-address"}),this.picture=f("img",{alt:"QR code of the address for the headset",width:180,height:180}),this.settings=f("div"),this.rooms={person:yp("person",this),robot:yp("robot",this)},this.file=f("input",{type:"text",value:"rooms","aria-label":"Name of the file of rooms"});let n=(s,r,o)=>f("button",{type:"button",onclick:()=>this._call(r,{name:this.file.value}).then(a=>a!==void 0&&me(o))},s);this.files=f("section",{"aria-label":"File of the rooms"},f("h2",{},"File of the rooms"),f("p",{},"Places, calibration points and limits of both rooms."),f("div",{class:"vr-buttons"},this.file,n("Save rooms","save_rooms","The rooms are saved."),n("Load rooms","load_rooms","The rooms are loaded."))),this.none=f("p",{},"This server has no virtual reality."),this.main=f("div",{class:"vr-columns"},f("section",{"aria-label":"Participants",class:"vr-wide"},f("h2",{},"Participants"),this.warnings,f("div",{class:"vr-buttons"},t("Pause for everybody","pause"),t("Continue","resume"),t("Stop robots","stop_robots","vr-stop"),t("Release robots","release_robots"),f("button",{type:"button",onclick:()=>this._save()},"Save recording")),f("div",{class:"vr-buttons"},this.switches.map(([,s])=>s)),f("div",{class:"vr-scroll",tabindex:"0",role:"region","aria-label":"Latency of participants"},f("table",{},f("thead",{},f("tr",{},Sv.map(s=>f("th",{scope:"col"},s||f("span",{class:"vr-quiet"},"Actions"))))),this.rows))),f("section",{"aria-label":"Headset"},f("h2",{},"Headset"),f("p",{},this.link),f("p",{},"Open this address in the browser of the headset:"),this.words,f("p",{},this.picture)),f("section",{"aria-label":"Delay and noise"},f("h2",{},"Delay and noise"),this.settings),this.rooms.person.element,this.rooms.robot.element,this.files),pt(this.root,this.none,this.main)}_take(t){let e=this.state;this.state=t,t.address&&e?.address!==t.address&&(this.link.href=`vr${location.hash}`,this.words.textContent=t.address,this.picture.src=this.app.connection.address("vr","link.svg"));let n=t.experiment?["participants are in the session of the tab Experiments"]:[];this.warnings.textContent=[...t.warnings,...n].join("; ");for(let[s,,r]of this.switches)r.checked=t[s];pt(this.rows,t.participants.length?t.participants.map(s=>this._row(s)):f("tr",{},f("td",{colspan:Sv.length},"Nobody is in virtual reality."))),JSON.stringify(e?.settings)!==JSON.stringify(t.settings)&&this._showSettings(t.settings);for(let[s,r]of Object.entries(this.rooms))r.take(t.rooms[s],t.participants)}_row(t){let e=[t.avatar,Mv(t.motion_median,t.motion_p95),Mv(t.picture_median,t.picture_p95),t.round_trip===null?"\u2013":`${t.round_trip.toFixed(1)} ms`,t.offset===null?"\u2013":`${t.offset.toFixed(4)} s`,t.lost,t.dropped,t.margin===null||t.margin===void 0?"\u2013":`${t.margin.toFixed(2)} m`,t.lost_tracking?"lost":["head",...t.hands].join(", ")],n=f("button",{type:"button","aria-label":`Measure body of ${t.avatar}`,onclick:()=>this._measure(t.avatar)},"Measure body"),s=f("button",{type:"button","aria-label":`Calibration pose of ${t.avatar}`,onclick:()=>this._call("calibrate_pose",{avatar:t.avatar})},"Calibration pose");return f("tr",{},e.map((r,o)=>f(o?"td":"th",o?{}:{scope:"row"},String(r))),f("td",{class:"vr-buttons"},n,s))}async _save(){let t=new Date().toISOString().slice(0,19).replace(/[:T]/g,"-"),e=await this._call("save",{name:`vr-${t}`});e&&me(`Saved: ${e.join(", ")}`)}_tellMeasure({avatar:t,stature:e,arm:n,body:s,difference:r,pose:o}){let a=`${Math.abs(100*r).toFixed(0)} cm ${r<0?"shorter":"longer"} in the avatar`;me(`${t}, ${o} pose: stature ${e.toFixed(2)} m, arms ${n.toFixed(2)} m (${a}), body ${s}.`)}async _measure(t){let e=await this._call("measure_body",{avatar:t});e&&me(`${t} is ${e.toFixed(2)} m tall; the trial runs from its start.`)}_showSettings(t){let e=[...wv.map(s=>({...s,kind:"number",value:Math.round(t[s.name]*s.factor*1e3)/1e3,low:0})),{name:"pause_when_lost",label:"Pause when tracking is lost",kind:"switch",value:t.pause_when_lost}],n=dn(e,()=>{let s=n.values();for(let{name:r,factor:o}of wv)s[r]=(s[r]??0)/o;this._call("set",{settings:s})});pt(this.settings,n.element)}};var _C=2e3,_u=class{constructor(t){this._close=t,this._figures=new Map,this.element=f("div",{class:"camera-images",role:"group","aria-label":"Camera images",hidden:!0})}show(t){let e=new Set(t.map(n=>n.name));for(let[n,s]of this._figures){let r=t.find(o=>o.name===n);(!e.has(n)||JSON.stringify(r)!==s.key)&&this._figures.delete(n)}for(let n of t)this._figures.has(n.name)||this._figures.set(n.name,new bp(n,()=>this._close(n.name)));pt(this.element,t.map(n=>this._figures.get(n.name).element)),this.element.hidden=!t.length}figure(t){return this._figures.get(t)}},bp=class{constructor(t,e){this.image=t,this.key=JSON.stringify(t),this.drawn=0,this.time=null,this._told=-1/0,this.canvas=f("canvas",{role:"img",width:t.width,height:t.height}),this._clock=f("span",{class:"camera-time"}),this._larger=f("button",{type:"button","aria-pressed":"false","aria-label":`Larger: ${t.title}`,onclick:()=>this._grow()},"Larger"),this.element=f("figure",{class:"camera-image"},f("figcaption",{},f("span",{class:"camera-title"},t.title),this._larger,f("button",{type:"button","aria-label":`Close: ${t.title}`,onclick:e},"\xD7")),f("div",{class:"camera-view"},this.canvas,this._clock),yC(t.scale)),this._tell(!0)}async draw(t,e,n){let s=this._order=(this._order??0)+1,r=await createImageBitmap(new Blob([t],{type:e}));s>=(this._latest??0)&&(this._latest=s,this.canvas.width!==r.width&&Object.assign(this.canvas,{width:r.width,height:r.height}),this.canvas.getContext("2d").drawImage(r,0,0),this.time=n,this.drawn+=1,this._clock.textContent=`${n.toFixed(2)} s`,this._tell(this.drawn===1||performance.now()-this._told>_C)),r.close()}_tell(t){if(!t)return;this._told=performance.now();let{title:e,width:n,height:s,rate:r}=this.image,o=this.time===null?"no image yet":`measured at ${this.time.toFixed(1)} s`;this.canvas.setAttribute("aria-label",`${e}, ${n} by ${s} pixels, ${r} Hz, ${o}`)}_grow(){let t=this.element.classList.toggle("large");this._larger.setAttribute("aria-pressed",String(t))}};function yC({colors:i,low:t,high:e,unit:n,nearer:s,beyond:r,names:o}){if(i){let a=f("i",{class:"camera-bar","aria-hidden":"true"});return a.style.background=`linear-gradient(to right, ${i.join(", ")})`,f("p",{class:"camera-scale"},`${t} ${n}`,a,`${e} ${n}`,xp(s,"nearer"),xp(r,"beyond"))}return o?f("p",{class:"camera-scale"},Object.entries(o).map(([a,l])=>xp(l,a))):null}function xp(i,t){let e=f("i",{class:"camera-swatch","aria-hidden":"true"});return e.style.background=i,f("span",{},e,t)}var yu=class{constructor(t,e){this.app=t,this.figures=new _u(s=>this._toggle(s,!1)),this.boxes=f("fieldset",{class:"choice cameras",hidden:!0}),this._images=[],this._revision=null;let n=(t.address.get("images")??"").split(",").filter(Boolean);this._chosen=new Set(n),this._asked=n.length>0,e.element.append(this.figures.element),t.connection.on("simulator.cameras",s=>this.take(s))}take(t){if(this._asked){this._asked=!1,this._ask();return}this._chosen=new Set(t),this._remember(),this._show()}loaded({images:t=[],revision:e}){this._images=t,this._revision=e,t.forEach((n,s)=>this.app.connection.draw(`cam${s}`,r=>this._draw(n.name,r))),this._show()}_show(){this.boxes.hidden=!this._images.length;let t=this.boxes.contains(document.activeElement)?document.activeElement.name:null;pt(this.boxes,f("legend",{},"Camera images"),this._images.map(({name:e,title:n,rate:s})=>{let r=f("input",{type:"checkbox",name:e,checked:this._chosen.has(e),onchange:()=>this._toggle(e,r.checked)});return f("label",{title:`${s} Hz`},r,n)})),t&&[...this.boxes.querySelectorAll("input")].find(e=>e.name===t)?.focus(),this.figures.show(this._images.filter(e=>this._chosen.has(e.name)))}_toggle(t,e){this._chosen[e?"add":"delete"](t),this._remember(),this._show(),this._ask()}_remember(){this.app.remember({images:[...this._chosen].join(",")||null})}_ask(){this.app.connection.call("simulator.cameras",{names:[...this._chosen]}).catch(()=>{})}_draw(t,{arrays:e,time:n}){let s=this.figures.figure(t);if(!(!s||e.revision[0]!==this._revision))return e.jpeg?s.draw(e.jpeg,"image/jpeg",n):s.draw(e.png,"image/png",n)}};var vu=class{constructor(t,e){this.app=t,this.picture=e;let n=[["3d","In space"],["2d","From above"]];this.view=f("select",{"aria-label":"View",onchange:()=>this._chooseView()},n.map(([s,r])=>f("option",{value:s,selected:s===e.view},r))),this.camera=f("select",{"aria-label":"Camera",onchange:()=>this.look(this.camera.value)}),this.boxes=f("div",{class:"choice"}),this.predictor=f("select",{"aria-label":"Predictor of the paths",onchange:()=>this._predict()}),this.legend=f("ul",{class:"picture-legend","aria-label":"Legend",hidden:!0}),e.element.append(this.legend),this.paths=f("label",{class:"row",hidden:!0},"Predictor",this.predictor),t.connection.on("simulator.predictor",s=>this.predicts(s)),document.addEventListener("theme",()=>this._explain()),this.images=new yu(t,e),this.element=f("details",{open:!0},f("summary",{},"Display"),f("div",{class:"row"},this.view,this.camera),this.boxes,this.paths,this.images.boxes),this._hidden=new Set((t.address.get("hide")??"").split(",").filter(Boolean)),this._extra=new Set((t.address.get("show")??"").split(",").filter(Boolean))}loaded(){let{scene:t}=this.picture;pt(this.camera,t.cameras().map(e=>f("option",{value:e.name,selected:e.name===t.camera},e.title)));for(let{name:e,visible:n}of t.layers())n&&this._hidden.has(e)&&t.setLayer(e,!1),!n&&this._extra.has(e)&&t.setLayer(e,!0);pt(this.boxes,t.layers().map(({name:e,title:n,visible:s})=>{let r=f("input",{type:"checkbox",checked:s,onchange:()=>this._toggle(e,r.checked)});return f("label",{},r,n)})),this.images.loaded(t.state.description),this._want()}know(t){let e=this.predictor.value||this._chosen;pt(this.predictor,t.map(n=>f("option",{value:n,selected:n===e},n))),this._explain()}predicts(t){this._chosen=t,this.predictor.value=t,this._explain()}_predict(){return he(()=>this.app.connection.call("simulator.predictor",{name:this.predictor.value}))}_explain(){let{scene:t}=this.picture,e=t.wanted(),n=br[this.app.theme==="dark"?"dark":"light"],s=e.flatMap(r=>o0(r,n,this._chosen??"constant-velocity"));this.paths.hidden=!e.includes("paths"),this.legend.hidden=!s.length,pt(this.legend,s.map(({color:r,text:o,width:a})=>{let l=f("i",{"aria-hidden":"true"});return l.style.background=r,l.style.height=`${a}px`,f("li",{},l,o)}))}look(t){let{scene:e}=this.picture;e.cameras().some(n=>n.name===t)&&(e.setCamera(t),this.camera.value=t,this.picture.wake())}reset(){this.picture.scene.reset(),this.camera.value=this.picture.scene.camera,this.picture.wake()}_chooseView(){this.picture.setView(this.view.value)}_toggle(t,e){this.picture.scene.setLayer(t,e),this._hidden[e?"delete":"add"](t),this._extra[e?"add":"delete"](t),this.app.remember({hide:[...this._hidden].join(",")||null,show:[...this._extra].join(",")||null}),this.picture.wake(),this._want()}_want(){this._explain(),this.app.connection.call("simulator.layers",{names:this.picture.scene.wanted()}).catch(()=>{})}};var vC=100,wp=.12,Tv={ArrowUp:[1,0,0],w:[1,0,0],ArrowDown:[-1,0,0],s:[-1,0,0],ArrowLeft:[0,1,0],a:[0,1,0],ArrowRight:[0,-1,0],d:[0,-1,0],q:[0,0,1],e:[0,0,-1]};function xC(i){let t=s=>{let r=Math.abs(i.axes[s]??0);return r>wp?Math.sign(i.axes[s])*Math.min(1,r-wp)/(1-wp):0},e=s=>i.mapping==="standard"&&i.buttons[s]?.pressed?1:0,n=i.mapping==="standard"||i.axes.length>2;return[-t(1)+e(12)-e(13),-t(n?2:0)+e(14)-e(15),n?-t(0):0]}var xu=class{constructor(t,e){this.app=t,this.actions=e,this.subject=null,this.limits={speed:.6,turn:1.2},this._down=new Set,this._stick=[0,0],this._sent="",this.knob=f("div",{class:"knob"}),this.pad=f("div",{class:"joystick",role:"img","aria-label":"Joystick: drag to drive; the keys W A S D or arrows do the same"},this.knob),this.text=f("p",{role:"status"}),this.stopButton=f("button",{type:"button",onclick:()=>this.stop()},"Give back"),this.element=f("div",{class:"drive",hidden:!0},this.text,this.pad,this.stopButton),this._listen()}async start(t,e){await this.stop(),!(t==="robot"&&await he(()=>this.app.connection.call("simulator.take_over",{robot:e}).then(()=>!0))!==!0)&&(this.subject={kind:t,name:e},this.element.hidden=!1,this.text.textContent=`You move ${e}: arrows or W A S D${t==="robot"?"":", Q and E sideways"}, the joystick, or a gamepad. Escape gives back.`,this.stopButton.textContent=t==="robot"?"Give back":"Stand still",this._sent="",document.activeElement?.blur?.(),this._timer=setInterval(()=>this._send(),vC),this.actions.started(this.subject))}async stop(){let{subject:t}=this;t&&(this.forget(),t.kind==="robot"?await he(()=>this.app.connection.call("simulator.release",{robot:t.name})):await he(()=>this.app.connection.call("simulator.walk",{avatar:t.name,forward:0})))}forget(){clearInterval(this._timer),this.subject=null,this._down.clear(),this.element.hidden=!0,this.actions.stopped()}input(){let t=[0,0,0];for(let s of this._down)Tv[s].forEach((r,o)=>t[o]+=r);let[e,n]=this._stick;t[0]-=n,t[1]-=e;for(let s of navigator.getGamepads?.()??[])s&&xC(s).forEach((r,o)=>t[o]+=r);return t.map(s=>Math.max(-1,Math.min(1,s)))}_send(){if(!this.subject||!this.app.connection.open)return;let{kind:t,name:e}=this.subject,[n,s,r]=this.input(),[o,a]=t==="robot"?["drive",{robot:e,forward:this.limits.speed*n,turn:this.limits.turn*s,left:this.limits.speed*r}]:["walk",{avatar:e,forward:1.5*n,turn:2*s,left:1.2*r}];this.app.connection.call(`simulator.${o}`,a).catch(()=>this.forget())}_listen(){let t=n=>!this.subject||n.target.closest?.("input, textarea, select, dialog");document.addEventListener("keydown",n=>{n.key==="Escape"&&this.subject&&this.stop();let s=n.key.length===1?n.key.toLowerCase():n.key;t(n)||!(s in Tv)||n.ctrlKey||n.metaKey||n.altKey||n.shiftKey||(n.preventDefault(),this._down.add(s))},!0),document.addEventListener("keyup",n=>this._down.delete(n.key.length===1?n.key.toLowerCase():n.key),!0),addEventListener("blur",()=>this._down.clear());let e=n=>{let{left:s,top:r,width:o,height:a}=this.pad.getBoundingClientRect(),[l,c]=[2*(n.clientX-s)/o-1,2*(n.clientY-r)/a-1],h=Math.max(1,Math.hypot(l,c));this._place(l/h,c/h)};this.pad.addEventListener("pointerdown",n=>{this.pad.setPointerCapture(n.pointerId),e(n)}),this.pad.addEventListener("pointermove",n=>this.pad.hasPointerCapture(n.pointerId)&&e(n));for(let n of["pointerup","pointercancel"])this.pad.addEventListener(n,()=>this._place(0,0))}_place(t,e){this._stick=[t,e],this.knob.style.transform=`translate(${38*t}px, ${38*e}px)`}};var bu=class{constructor(t,e){this.app=t,this.parts=e,this.events=[],this.list=f("ol",{class:"events"}),this.branch=f("button",{type:"button",onclick:()=>this._dialog()},"Branch from here\u2026"),this.share=f("progress",{"aria-label":"Progress of the branch",max:1,value:0,hidden:!0}),this.element=f("details",{open:!0,hidden:!0},f("summary",{},"Episode"),this.branch,this.share,f("p",{class:"faint"},"Keys J and K jump to the event before and after"),this.list),t.connection.on("simulator.branch",n=>this._progress(n))}show(t){this.events=t,pt(this.list,t.map(e=>f("li",{class:e.kind.replace(" ","-")},f("button",{type:"button",onclick:()=>this.parts.transport.seek(e.time)},`${e.time.toFixed(1)} s  ${e.kind}: ${e.about}`)))),t.length||pt(this.list,f("li",{class:"faint"},"No contact, near miss or stall"))}jump(t){let e=this.parts.transport.status.time,n=this.events.filter(r=>t>0?r.time>e+.05:r.time<e-.05),s=t>0?n[0]:n.at(-1);s&&this.parts.transport.seek(s.time)}_dialog(){let t=this.parts.transport.status.time,e=dn([{name:"navigator",label:"Navigator of the robot",kind:"choice",value:"",choices:[["","as recorded"],...this.parts.names().navigators]},{name:"more",label:"Other values, such as robot/drive/max-speed=0.3",kind:"text",value:""}]),n=async()=>{let{navigator:s,more:r}=e.values(),o=Object.fromEntries(r.split(/\s+/).filter(Boolean).map(a=>[a.split("=")[0],a.slice(a.indexOf("=")+1)]));return s&&(o["robot/navigator/type"]=s),await he(()=>this.app.connection.call("simulator.branch",{at:t,changes:o}))!==void 0};we(`Branch at ${t.toFixed(1)} s`,e.element,[["Cancel",()=>!0],["Branch",n]])}async _progress({name:t,share:e,done:n,error:s,at:r,outcome:o}){if(this.share.hidden=n===!0||s!==void 0,this.share.value=e??0,s)return me(s,"error");if(n)return me(`${t}: ${o}`),await this.parts.library.loadEpisodes(),this.parts.library.openEpisode(t,r)}};var Av=.3,wu=class{constructor(t,e){this.app=t,this.actions=e,this.chosen=null,this.live=!1,this.navigators=[],this.list=f("select",{"aria-label":"Choose a person or robot",onchange:()=>this._choose(),onfocus:()=>this.refresh()}),this.table=f("tbody"),this.buttons=f("div",{class:"buttons"}),this.x=f("input",{type:"number",step:"any","aria-label":"x [m]"}),this.y=f("input",{type:"number",step:"any","aria-label":"y [m]"}),this.place=f("div",{class:"place"},f("span",{},"x, y [m]"),this.x,this.y,f("button",{type:"button",onclick:()=>this.goal(this._point())},"Set goal"),f("button",{type:"button",onclick:()=>this.move(this._point())},"Move there")),this.element=f("details",{open:!0},f("summary",{},"Inspector"),f("div",{class:"chosen"},this.list),f("table",{},this.table),this.buttons,this.place),this._show(null)}async refresh(){let t=await this.app.connection.call("simulator.people").catch(()=>[]),e=n=>`${n.kind} ${n.name||n.id}`;pt(this.list,f("option",{value:""},"nobody chosen"),t.map(n=>f("option",{value:`${n.kind} ${n.id}`},e(n)))),this.list.value=this.chosen?`${this.chosen.kind} ${this.chosen.id}`:""}async select(t){return this.chosen=t,this.actions.chosen(t),await this.refresh(),this.update()}async update(){if(!(!this.chosen||this._asking)){this._asking=!0;try{this._show(await this.app.connection.call("simulator.inspect",{id:this.chosen.id}))}catch{this._show(null)}finally{this._asking=!1}}}goal(t){if(!this.state||!t)return;let{kind:e,id:n,name:s}=this.state;this.order(e==="robot"?{order:"goal",robot:s,...t}:{order:"redirect",person:n,...t})}move(t){this.state&&t&&this.order({order:"move",person:this.state.id,...t})}remove(){if(!this.state)return;let{kind:t,id:e,name:n}=this.state;this.order(t==="robot"?{order:"remove-element",path:`robot[${n}]`}:{order:"remove",person:e}),this.select(null)}order(t){return he(()=>this.app.connection.call("simulator.order",{order:t})).then(()=>this.update())}_choose(){let[t,e]=this.list.value.split(" ");this.select(t?{kind:t,id:Number(e)}:null)}_point(){return this.x.value===""||this.y.value===""?null:{x:Number(this.x.value),y:Number(this.y.value)}}_show(t){let e=this.state&&`${this.state.kind} ${this.state.id}`;this.state=t,pt(this.table,(t?.rows??[]).map(([s,r,o])=>f("tr",{},f("th",{scope:"row"},s),f("td",{},o?`${r} ${o}`:String(r))))),this.place.hidden=!t||!this.live;let n=t&&`${t.kind} ${t.id} ${this.live}`;n!==this._made&&(this._made=n,t&&e!==`${t.kind} ${t.id}`&&([this.x.value,this.y.value]=t.goal.map(s=>s.toFixed(2))),pt(this.buttons,t&&this.live?this._buttons(t):[]))}_buttons({kind:t,name:e,values:n}){let s=(c,h)=>f("button",{type:"button",onclick:h},c),r=(c,h,d)=>s(c,()=>this.move({x:this.state.x+Av*h,y:this.state.y+Av*d})),o=[s("Goal by click",()=>this.actions.tool("goal")),s("Move by click",()=>this.actions.tool("move")),s("Parameters",()=>this.actions.values(n)),s("Remove",()=>this.remove())];if(t==="person"){let c=[r("Push +x",1,0),r("Push \u2212x",-1,0),r("Push +y",0,1),r("Push \u2212y",0,-1)];return e&&o.push(s("Walk as this person",()=>this.actions.drive("avatar",e))),[...o,...c]}let a=f("select",{"aria-label":"Navigator",onchange:()=>this._navigator(a.value)},this.navigators.map(c=>f("option",{},c))),l=this.state.rows.find(([c])=>c==="navigator");return a.value=l?l[1]:"",[...o,s("Drive",()=>this.actions.drive("robot",e)),f("label",{class:"field"},f("span",{},"Navigator"),a)]}_navigator(t){this.order({order:"parameter",path:`robot[${this.state.name}]/navigator/type`,value:t})}};var Su=class{constructor(t){this.app=t,this.trials=f("ul",{class:"trials"}),this.episodes=f("ul",{class:"episodes"}),this.search=f("input",{type:"search","aria-label":"Search trials",placeholder:"Search trials",oninput:()=>this._filter()}),this.file=f("input",{type:"file",accept:".xml,.mcap","aria-label":"Open a trial or an episode from a file",onchange:()=>this._upload()}),this.element=f("aside",{class:"library","aria-label":"Trials and episodes"},f("h2",{},"Trials"),this.search,this.trials,f("h2",{},"Episodes"),this.episodes,f("label",{class:"field"},f("span",{},"Open a file (.xml, .mcap)"),this.file))}async load(){let[t]=await Promise.all([this.app.connection.call("simulator.trials"),this.loadEpisodes()]);pt(this.trials,t.map(e=>this._trial(e))),this._filter()}async loadEpisodes(){let t=await this.app.connection.call("simulator.episodes");pt(this.episodes,t.length?t.map(e=>f("li",{},f("button",{type:"button",onclick:()=>this.openEpisode(e)},e))):f("li",{class:"faint"},"None yet: save a run"))}openEpisode(t,e=null){return he(()=>this.app.connection.call("simulator.open_episode",{name:t,at:e}))}async open(t,e={},n=null){let s=await he(()=>this.app.connection.call("simulator.open",{name:t,settings:e,seed:n}));for(let r of s?.remarks??[])me(r);return s}mark(t){for(let e of this.element.querySelectorAll("button[aria-current]"))e.removeAttribute("aria-current");this.trials.querySelector(`button[data-name="${CSS.escape(t??"")}"]`)?.setAttribute("aria-current","true")}_trial({name:t,title:e,built_in:n,parameters:s}){let r=n&&f("img",{src:this.app.connection.address("simulator",`thumbnail/${t}.svg`),alt:"",loading:"lazy"}),o=f("button",{type:"button","data-name":t,title:e,onclick:()=>this.open(t)},r||null,f("span",{},f("strong",{},t),f("small",{},e))),a=s.length?f("button",{type:"button",class:"more","aria-label":`Settings of ${t}`,onclick:()=>this._settings(t,s)},"Settings"):null;return f("li",{"data-words":`${t} ${e}`.toLowerCase()},o,a)}_settings(t,e){let n=dn([...e,{name:"world",label:"World",kind:"choice",value:"",choices:[["","as in the trial"],"planar","physics"]}]),s=async()=>{let r=Object.fromEntries(e.map(l=>[l.name,l.value])),o=n.values(),a=Object.fromEntries(Object.entries(o).filter(([l,c])=>c!==""&&c!==null&&c!==r[l]));return await this.open(t,a)!==void 0};we(`Settings of ${t}`,n.element,[["Cancel",()=>!0],["Run",s]])}_filter(){let t=this.search.value.toLowerCase().split(/\s+/).filter(Boolean);for(let e of this.trials.children)e.hidden=!t.every(n=>e.dataset.words.includes(n))}async _upload(){let t=this.file.files[0];t&&(await he(async()=>{let{session:e}=this.app.connection,n=await fetch(`api/${e}/upload?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t});if(!n.ok)throw new Error((await n.text()).trim());let{name:s}=await n.json();await(s.endsWith(".mcap")?this.openEpisode(s):this.open(s)),await this.load()}),this.file.value="")}};var Rv=3e3,Cv=["--data-1","--data-2","--data-3","--data-4","--data-5","--data-6"],bC=[[],[8,4],[2,3],[8,3,2,3],[12,4],[4,4]],wC=400,Mu=class{constructor(t){this.app=t,this.kinds=[],this.metrics=[],this.rows=[],this.chosen=new Set((t.address.get("plots")??"clearance,speed").split(",").filter(Boolean)),this.plots=new Map,this._drawn=0,this.choice=f("fieldset",{class:"choice"},f("legend",{},"Plots")),this.metric=f("select",{"aria-label":"Add a metric of the run",onchange:()=>this._add()}),this.area=f("div"),this.element=f("details",{open:!0},f("summary",{},"Plots"),this.area,this.choice,this.metric)}know(t){this.kinds=t,this._listChoice()}begin(t){this.rows=t.map(([e,n])=>[e,n]),this._draw(!0)}whole(t){let e=Object.keys(t).filter(n=>n!=="time");this.rows=t.time.map((n,s)=>[n,Object.fromEntries(e.map(r=>[r,t[r][s]]))]),this._draw(!0)}take(t){let e=Object.keys(t.metrics??{}).sort();if(e.join()!==this.metrics.join()&&(this.metrics=e,pt(this.metric,f("option",{value:""},"Add a metric of the run\u2026"),e.map(r=>f("option",{},r)))),t.kind==="episode"){for(let r of this.plots.values())r.mark(t.time);return}if(t.state==="preparing"||!Object.keys(t.values??{}).length)return;let n=this.rows.at(-1);if(n&&n[0]>=t.time)return;let s=Object.fromEntries(Object.entries(t.metrics).filter(([r])=>this.chosen.has(r)));this.rows.push([t.time,{...s,...t.values}]),this.rows.length>Rv&&(this.rows=this.rows.filter((r,o)=>o%2||o>Rv/2)),this._draw(!1)}_listChoice(){let t=this.kinds.map(({name:e,title:n})=>{let s=f("input",{type:"checkbox",checked:this.chosen.has(e),onchange:()=>this._toggle(e,s.checked)});return f("label",{},s,n)});pt(this.choice,f("legend",{},"Show"),t)}_add(){this.metric.value&&this._toggle(this.metric.value,!this.chosen.has(this.metric.value)),this.metric.value=""}_toggle(t,e){e?this.chosen.add(t):this.chosen.delete(t),this.app.remember({plots:[...this.chosen].join(",")}),this._draw(!0)}_draw(t){if(!(!this.element.open||!this.element.isConnected)&&!(!t&&performance.now()-this._drawn<wC)){this._drawn=performance.now();for(let[e,n]of this.plots)this.chosen.has(e)||(n.destroy(),this.plots.delete(e));for(let e of this.chosen)this.plots.has(e)||this.plots.set(e,this._make(e)),this.plots.get(e).set([this.rows.map(([n])=>n),this.rows.map(([,n])=>n[e]??null)])}}_make(t){let e=this.kinds.findIndex(a=>a.name===t),{title:n,unit:s}=this.kinds[e]??{title:t.replaceAll("_"," "),unit:""},r=e<0?5:e%Cv.length,o=[{label:n,unit:s,colour:Cv[r],dash:bC[r]}];return Gl(this.area,{title:n,x:{label:"time",unit:"s"},series:o,height:110})}};var Pv={person:["Click where the person starts","Click the goal of the person"],robot:["Click where the robot starts","Click the goal of the robot"],goal:["Click the goal"],move:["Click the new place"],you:["Click where you start; the run begins anew"]},Eu=class{constructor(t,e){this.app=t,this.parts=e,this.names={navigators:[],robots:[]},this.tool=null,this.points=[];let n=(s,r)=>f("button",{type:"button","aria-pressed":"false","data-tool":s,onclick:()=>this.choose(this.tool===s?null:s)},r);this.buttons=[n("person","Add person"),n("robot","Add robot"),n("you","Be a person")],this.robot=f("select",{"aria-label":"Type of a new robot"}),this.exact=f("button",{type:"button",onclick:()=>this._dialog()},"Add at x, y\u2026"),this.element=f("div",{class:"tools",role:"group","aria-label":"Change the scene"},this.buttons,this.robot,this.exact)}know(t){this.names=t,pt(this.robot,t.robots.map(e=>f("option",{},e))),t.robots.includes("turtlebot2")&&(this.robot.value="turtlebot2")}set live(t){this.element.hidden=!t,t||this.choose(null)}choose(t){this.tool=t,this.points=[];for(let e of this.buttons)e.setAttribute("aria-pressed",String(e.dataset.tool===t));this._hint()}async place({x:t,y:e}){let n={x:Number(t.toFixed(2)),y:Number(e.toFixed(2))},{tool:s}=this;if(this.points.push(n),this.points.length<Pv[s].length)return this._hint();let[r,o]=this.points;return this.choose(null),s==="goal"?this.parts.inspector.goal(n):s==="move"?this.parts.inspector.move(n):s==="you"?this._become(n):this._add(s,r,o)}_hint(){this.parts.picture.placing=this.tool!==null,this.parts.picture.say(this.tool?`${Pv[this.tool][this.points.length]} (Escape cancels)`:"")}_add(t,e,n){return he(async()=>(t==="person"?await this.app.connection.call("simulator.order",{order:{order:"add-person",...e,goal_x:n.x,goal_y:n.y}}):await this.app.connection.call("simulator.add_robot",{type:this.robot.value,...e,goal_x:n.x,goal_y:n.y}),await this.parts.inspector.refresh(),!0))}async _become(t){let e=await he(()=>this.app.connection.call("simulator.become_person",t));e&&this.parts.became(e)}_dialog(){let t=(r,o,a)=>({name:r,label:o,kind:"number",unit:"m",value:a}),e=[["person","Person"],["robot",`Robot (${this.robot.value})`],["you","Yourself"]],n=dn([{name:"kind",label:"What",kind:"choice",value:"person",choices:e},t("x","x",0),t("y","y",0),t("goal_x","goal x",3),t("goal_y","goal y",0)]),s=async()=>{let{kind:r,x:o,y:a,goal_x:l,goal_y:c}=n.values();return r==="you"?this._become({x:o,y:a}):await this._add(r,{x:o,y:a},{x:l,y:c})===!0};we("Add",n.element,[["Cancel",()=>!0],["Add",s]])}};var Tu=[.1,.25,.5,1,2,5,10,null],Sp=i=>i===null?"no limit":`${i}x`,Au=class{constructor(t,e){this.app=t,this.status={state:"none"};let n=(r,o,a,l)=>f("button",{type:"button",title:l?`${o} (${l})`:o,onclick:a},r);this.run=n("Run","Run",()=>this.toggle(),"Space"),this.run.classList.add("main"),this.stepButton=n("Step","Step",()=>this.step(),"."),this.again=n("Restart","Restart",()=>e.restart(!1),"r"),this.seed=n("New seed","Restart with another seed",()=>e.restart(!0),"n"),this.save=n("Save","Save the recording",e.save),this.speed=f("select",{"aria-label":"Speed relative to real time",onchange:()=>this._chooseSpeed()},Tu.map(r=>f("option",{value:String(r)},Sp(r)))),this.scrubber=f("input",{type:"range","aria-label":"Time [s]",min:0,max:1,step:"any",hidden:!0,oninput:()=>this._seek()}),this.progress=f("progress",{"aria-label":"Simulated time",max:1,value:0}),this.ticks=f("div",{class:"event-ticks","aria-hidden":"true"}),this.clock=f("output",{class:"clock","aria-label":"Time"},"0.0 s"),this.line=f("p",{class:"status-line"});let s=f("div",{class:"track"},this.ticks,this.scrubber,this.progress);this.element=f("div",{class:"transport",role:"group","aria-label":"Run"},this.run,this.stepButton,s,this.clock,this.speed,this.again,this.seed,this.save),this._target=null,this._seeking=!1}toggle(){return this._call(this.status.state==="running"||this.status.state==="preparing"?"pause":"play")}step(t=1){return this._call("step",{count:t})}change(t){let e=Tu.findIndex(s=>s===this.status.speed),n=Tu[Math.min(Tu.length-1,Math.max(0,(e<0?3:e)+t))];return this.status.speed=n,this._call("speed",{speed:n})}jump(t){this.seek((this._target??this.status.time)+t)}async seek(t){if(this.status.kind==="episode"&&(this._target=Math.min(this.status.duration,Math.max(this.status.begin,t)),!this._seeking)){this._seeking=!0;try{for(;this._target!==null;){let e=this._target;await he(()=>this.app.connection.call("simulator.seek",{time:e})),this._target===e&&(this._target=null)}}finally{this._seeking=!1}}}show(t){this.status=t;let e=t.kind==="episode",n=t.state==="running"||t.state==="preparing";this.run.textContent=n?"Pause":"Run";let s=["failed","none"].includes(t.state)||t.state==="ended"&&!e;this.run.disabled=this.stepButton.disabled=s;for(let o of[this.again,this.seed,this.save])o.hidden=e;this.scrubber.hidden=!e,this.progress.hidden=e;let r=t.time??0;e?(this.scrubber.min=t.begin,this.scrubber.max=t.duration,this._target===null&&document.activeElement!==this.scrubber&&(this.scrubber.value=r),this.scrubber.setAttribute("aria-valuetext",`${r.toFixed(1)} s`)):this.progress.value=t.duration?Math.min(1,r/t.duration):0,this.clock.textContent=`${r.toFixed(1)} / ${(t.duration??0).toFixed(0)} s`,document.activeElement!==this.speed&&(this.speed.value=String(t.speed))}mark(t){let{begin:e=0,duration:n=1}=this.status;pt(this.ticks,t.slice(0,300).map(s=>{let r=f("i",{class:s.kind.replace(" ","-")});return r.style.left=`${100*(s.time-e)/Math.max(1e-9,n-e)}%`,r}))}_chooseSpeed(){this._call("speed",{speed:this.speed.value==="null"?null:Number(this.speed.value)})}_seek(){this.seek(Number(this.scrubber.value))}_call(t,e={}){return he(()=>this.app.connection.call(`simulator.${t}`,e))}};var Mp=40,Ru=class{constructor(t){this.app=t,this.live=!1,this.rows=[],this.search=f("input",{type:"search","aria-label":"Search values",placeholder:"robot/drive",oninput:()=>this._list()}),this.list=f("div",{class:"values"}),this.element=f("details",{ontoggle:()=>this.element.open&&this.load()},f("summary",{},"Values of the trial"),this.search,this.list)}async load(){this.rows=await this.app.connection.call("simulator.values").catch(()=>[]),this._list()}async open(t){this.element.open=!0,this.search.value=t,await this.load(),this.element.scrollIntoView({block:"nearest"})}_list(){let t=this.search.value.toLowerCase().split(/\s+/).filter(Boolean),e=this.rows.filter(({path:n,note:s})=>t.every(r=>n.includes(r)||s.toLowerCase().includes(r)));pt(this.list,e.slice(0,Mp).map(n=>this._row(n)),e.length>Mp?f("p",{class:"faint"},`${e.length-Mp} more: type more letters`):null)}_row(t){let e=`${t.path}${t.unit?` [${t.unit}]`:""}`,n={"aria-label":e,disabled:!this.live,onchange:()=>this._change(t,r)},s=t.kind==="switch"?["true","false"]:t.choices,r=s?f("select",n,s.map(o=>f("option",{selected:o===t.text},o))):f("input",{...n,type:"text",inputmode:t.kind==="text"?"text":"decimal",value:t.text,size:8});return f("div",{class:"value",title:t.note},f("span",{},e),r,t.live?null:f("small",{},"at a restart"))}async _change(t,e){let n=e.value;await he(async()=>(t.live?await this.app.connection.call("simulator.set_value",{path:t.path,text:n}):await this.app.connection.call("simulator.restart",{settings:{[t.path]:n}}),me(`${t.path} = ${n}`),!0))?await this.load():e.value=t.text}};var SC=5e3,Iv=2e3;function MC({compiling:i,recorded:t}){return i?`Compiling for the first run on this computer; until then ${t?"you see a recording of the same run":"everybody walks straight"}`:t?"":"Preparing the simulation"}var Ep=class{constructor(t,e){this.app=e,this.status={state:"none"},this.source={},this.latency=null,this.fps=0,this._make(),t.classList.add("simulator"),t.append(this.library.element,f("div",{class:"middle"},this.tools.element,this.picture.element,this.drive.element,this.transport.element,this.line,this.summary),this.side),this._listen(),this._keys(),setInterval(()=>this._measure(),Iv),setInterval(()=>this._summarize(),SC)}show(){this.picture.shown=!0}hide(){this.picture.shown=!1}greet(t){this.plots.know(t.plots),this.display.predicts(t.predictor),this.display.images.take(t.cameras),this._opened(t.source,t.status),this.plots.begin(t.history),this._take(t.status),this.library.load().catch(e=>me(e.message,"error")),this.app.connection.call("simulator.names").then(e=>{this.tools.know(e),this.inspector.navigators=e.navigators,this.display.know(e.predictors)},()=>{}),t.status.state!=="none"&&this.app.connection.call("simulator.show_frame").catch(()=>{})}_make(){let{app:t}=this;this.library=new Su(t),this.picture=new qo(t,{select:e=>this.inspector.select(e),place:e=>this.tools.place(e),loaded:()=>this._loaded()}),this.transport=new Au(t,{restart:e=>this._restart(e),save:()=>this._save()}),this.values=new Ru(t),this.drive=new xu(t,{started:e=>this._driving(e),stopped:()=>this.display.look("free")}),this.inspector=new wu(t,{chosen:e=>this.picture.mark(e?.kind??null,e?.id),tool:e=>this.tools.choose(e),drive:(e,n)=>this.drive.start(e,n),values:e=>this.values.open(e)}),this.tools=new Eu(t,{inspector:this.inspector,picture:this.picture,became:e=>this._became(e)}),this.display=new vu(t,this.picture),this.plots=new Mu(t),this.episode=new bu(t,{transport:this.transport,library:this.library,names:()=>this.tools.names}),this.line=f("p",{class:"status-line"}),this.summary=f("p",{class:"summary",role:"status","aria-label":"Summary of the picture"}),this.side=f("aside",{class:"side","aria-label":"Inspector, display and plots"},this.episode.element,this.inspector.element,this.display.element,this.plots.element,this.values.element)}_listen(){let{connection:t}=this.app;t.on("simulator.status",e=>this._take(e)),t.on("simulator.opened",({source:e,status:n})=>{this._opened(e,n),this.plots.begin([]),this._take(n)}),t.draw("scene",e=>this.picture.take(e)),t.on("lost",()=>this.drive.subject&&this.drive.forget())}_opened(t,e){this.source=t,this.picture.forget(),this.picture.preview(e.state==="preparing"?t.preview??null:null),this.library.mark(t.name);let n=t.kind==="run";this.tools.live=this.inspector.live=this.values.live=n,this.episode.element.hidden=n||!t.kind,this.transport.mark([]),this._readEpisode=!n,this._waiting||this.inspector.select(null),this.drive.subject&&this.drive.forget()}async _take(t){let e=this.status;this.status=t,this.transport.show(t),this.plots.take(t),this._showLine(),t.problems?.length&&t.problems.join()!==e.problems?.join()&&me(t.problems.join(`
`),"error"),t.state==="preparing"?this.picture.say(MC(t)):(e.state==="preparing"||t.state==="failed")&&this.picture.say(""),t.state==="failed"&&this.picture.preview(null),t.state==="ended"&&e.state!=="ended"&&this.drive.subject&&this.drive.forget(),this._readEpisode&&t.kind==="episode"&&!["preparing","failed"].includes(t.state)&&(this._readEpisode=!1,await he(()=>this._showEpisode())),this.inspector.element.open&&this.inspector.update()}async _showEpisode(){let{events:t,series:e}=await this.app.connection.call("simulator.episode");this.episode.show(t),this.transport.mark(t),this.plots.whole(e)}_loaded(){if(this.display.loaded(),this.inspector.refresh(),this._waiting){let t=this._waiting;this._waiting=null,this._walk(t)}}_driving({kind:t,name:e}){let n=this.picture.scene.state.description?.robots??[];t==="robot"&&this.inspector.select({kind:t,id:n.find(s=>s.name===e)?.id}),this.display.look("follow"),t==="avatar"&&this.display.look("eyes")}_became(t){this._waiting=t,this.status.trial&&this.picture.scene.state.frame&&this.status.state==="running"&&this.picture.wake()}async _walk(t){let n=(await this.app.connection.call("simulator.people")).find(s=>s.name===t);n&&await this.inspector.select({kind:"person",id:n.id}),await this.drive.start("avatar",t)}_restart(t){if(this.status.kind!=="run")return;let e=t?Math.floor(Math.random()*1e6):null;return he(()=>this.app.connection.call("simulator.restart",{seed:e}))}async _save(){let t=await he(()=>this.app.connection.call("simulator.save"));t&&(me(`Saved as ${t}`),await this.library.loadEpisodes())}async _measure(){let t=this.picture.frames;if(this.fps=(t-(this._drawn??t))/(Iv/1e3),this._drawn=t,!this.app.connection.open)return;let e=performance.now();await this.app.connection.call("simulator.ping").catch(()=>{}),this.latency=performance.now()-e,this._showLine()}_showLine(){let{state:t,trial:e,seed:n,time:s,factor:r,values:o,outcome:a,orders:l,speed:c,problems:h}=this.status;if(!e){this.line.textContent=h?.length?h[0]:"Nothing is open";return}let d=t==="ended"&&a?`ended: ${a}`:t,u=[`${e}, seed ${n}: ${d}`,`${(s??0).toFixed(1)} s`,`speed ${Sp(c)}`];t==="running"&&r&&u.push(`real-time factor ${r.toFixed(2)}`),o?.people!==void 0&&u.push(`${o.people} people`),u.push(`${l} orders`,`${this.fps.toFixed(0)} pictures/s`),this.latency!==null&&u.push(`latency ${this.latency.toFixed(0)} ms`),this.line.textContent=u.join("  \xB7  ")}_summarize(){let{state:t,values:e,time:n}=this.status;if(!e||t!=="running"||e.people===void 0||this.picture.element.offsetParent===null)return;let s=e.clearance===null||e.clearance===void 0?"":`; the nearest person is ${e.clearance.toFixed(1)} m from the robot`;this.summary.textContent=`At ${n.toFixed(0)} s: ${e.people} people${s}.`}_keys(){let{transport:t}=this,e=()=>this.status.kind==="episode",n=s=>()=>!this.drive.subject&&(e()?t.jump(s):s>0&&t.step());this.app.keys.add("simulator",[[" ","Run or pause",()=>t.toggle()],[".","One step",()=>t.step()],["ArrowRight","One step; in an episode: 1 s ahead",n(1)],["ArrowLeft","In an episode: 1 s back",n(-1)],["[","Slower",()=>t.change(-1)],["]","Faster",()=>t.change(1)],["r","Restart",()=>this._restart(!1)],["n","Restart with another seed",()=>this._restart(!0)],["j","Event before",()=>this.episode.jump(-1)],["k","Event after",()=>this.episode.jump(1)],["+","Add a person by two clicks",()=>this.tools.choose("person")],["g","Goal of the chosen one by a click",()=>this.inspector.state&&this.tools.choose("goal")],["Delete","Remove the chosen one",()=>this.inspector.remove()],["f","Follow",()=>this.display.look("follow")],["i","Through the eyes of the chosen one; Shift and arrows look around",()=>this.display.look("eyes")],["o","Overview",()=>this.display.reset()],["v","In space or from above",()=>this._turnView()],["Escape","Cancel; give a robot back",()=>this.tools.choose(null)]])}_turnView(){this.display.view.value=this.picture.view==="3d"?"2d":"3d",this.picture.setView(this.display.view.value)}},Lv={name:"simulator",title:"Simulator",mount:(i,t)=>new Ep(i,t)};var Dv=[Lv,bv,Zg,Jg,Zy,Jy,Ev];window.crowdbot=new xl(document.getElementById("app"),Dv);
