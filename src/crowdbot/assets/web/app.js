var By=[Float32Array,Int16Array,Uint16Array,Uint8Array,Int32Array,Uint32Array,Float64Array],yp=32,xp=16;function vp(i,t){let e="";for(let n=0;n<8;n++){let s=i.getUint8(t+n);s&&(e+=String.fromCharCode(s))}return e}function Ps(i){let t=new DataView(i);if(t.getUint32(0)!==1128416817)throw new Error("not a state frame");let e=t.getUint32(20,!0),n={channel:vp(t,8),sequence:t.getUint32(16,!0),time:t.getFloat64(24,!0),arrays:{},columns:{}},s=yp+xp*e;for(let r=0;r<e;r++){let o=yp+xp*r,a=By[t.getUint16(o+8,!0)],l=t.getUint32(o+12,!0);s+=(8-s%8)%8;let c=vp(t,o);n.arrays[c]=new a(i,s,l),n.columns[c]=t.getUint16(o+10,!0),s+=l*a.BYTES_PER_ELEMENT}return n}var bp=[250,500,1e3,2e3],ll=class extends EventTarget{constructor(t){super(),this.session=t,this.open=!1,this._calls=new Map,this._frames=new Map,this._number=0,this._failures=0,this._connect()}call(t,e={}){return new Promise((n,s)=>{if(!this.open)return s(new Error("the server is not connected"));let r=++this._number;this._calls.set(r,{resolve:n,reject:s}),this._socket.send(JSON.stringify({id:r,call:t,args:e}))})}on(t,e){let n=s=>e(s.detail);return this.addEventListener(t,n),()=>this.removeEventListener(t,n)}draw(t,e){this._frames.set(t,e)}address(t,e,n={}){let s=new URLSearchParams(n).toString();return`api/${this.session}/${t}/${e}${s?`?${s}`:""}`}_connect(){let t=new URL(`api/${this.session}/socket`,location.href);t.protocol=t.protocol.replace("http","ws");let e=new WebSocket(t);e.binaryType="arraybuffer",e.onopen=()=>{this.open=!0,this._failures=0,this._emit("connected")},e.onmessage=n=>this._receive(n.data),e.onclose=()=>this._lost(),this._socket=e}async _receive(t){if(typeof t!="string"){let s=Ps(t);try{await this._frames.get(s.channel)?.(s)}finally{this._socket.readyState===WebSocket.OPEN&&this._socket.send(JSON.stringify({drawn:s.sequence}))}return}let e=JSON.parse(t);if(e.event)return this._emit(e.event,e.data);let n=this._calls.get(e.id);this._calls.delete(e.id),"error"in e?n?.reject(new Error(e.error)):n?.resolve(e.result)}_lost(){this.open=!1;for(let{reject:e}of this._calls.values())e(new Error("the connection to the server was lost"));this._calls.clear(),this._emit("lost");let t=bp[Math.min(this._failures++,bp.length-1)];setTimeout(()=>this._connect(),t)}_emit(t,e){this.dispatchEvent(new CustomEvent(t,{detail:e}))}};var Sp=i=>i!=null&&i!==!1;function _(i,t={},...e){let n=document.createElement(i);for(let[s,r]of Object.entries(t))s.startsWith("on")?n.addEventListener(s.slice(2),r):r===!0?n.setAttribute(s,""):r!==!1&&r!==null&&r!==void 0&&n.setAttribute(s,r);return n.append(...e.flat().filter(Sp)),n}function It(i,...t){return i.replaceChildren(...t.flat().filter(Sp)),i}function Dn(i,t,e=null){return _("label",{class:"field"},_("span",{},i),t,e&&_("small",{},e))}function De(i,t,e=[["Close",()=>!0]]){let n=_("dialog",{"aria-label":i}),s=async r=>{await r()!==!1&&n.close()};return n.append(_("h2",{},i),_("div",{class:"dialog-body"},t),_("div",{class:"dialog-buttons"},e.map(([r,o],a)=>_("button",{type:"button",class:a===e.length-1?"main":"",onclick:()=>s(o)},r)))),n.addEventListener("close",()=>n.remove()),document.body.append(n),n.showModal(),n}var cl=_("div",{class:"messages",role:"status","aria-live":"polite"}),Mp=cl;function Te(i,t="note"){let e=_("div",{class:`message ${t}`},_("span",{},i));for(e.append(_("button",{type:"button","aria-label":"Close message",onclick:()=>e.remove()},"\xD7")),cl.append(e);cl.children.length>4;)cl.firstChild.remove();t!=="error"&&setTimeout(()=>e.remove(),6e3)}async function ve(i){try{return await i()}catch(t){Te(t.message,"error");return}}var hl=class{constructor(){this._sets=new Map,this.active=null,document.addEventListener("keydown",t=>this._press(t))}add(t,e){this._sets.set(t,[...this._sets.get(t)??[],...e])}list(){return[...this._sets.get(this.active)??[],...this._sets.get(null)??[]]}_press(t){if(t.ctrlKey||t.metaKey||t.altKey)return;let e=t.target;if(e.closest("input, textarea, select, dialog, [contenteditable]")||(t.key===" "||t.key==="Enter")&&e.closest("button, summary, a")||t.key.startsWith("Arrow")&&e.closest("[role=tab], [role=slider], [role=listbox]"))return;let n=this.list().find(([s])=>s===t.key);n&&(t.preventDefault(),n[2](t))}};function wp(i){return{" ":"Space",ArrowRight:"\u2192",ArrowLeft:"\u2190",ArrowUp:"\u2191",ArrowDown:"\u2193"}[i]??i}var ul=class{constructor(t,e){this.tabs=e,this.keys=new hl,this.address=new URLSearchParams(location.hash.slice(1)),this.connection=new ll(this.address.get("session")??"main"),this._views=new Map,this._layout(t),this._listen(),this.select(this.address.get("tab")??e[0].name)}tab(t){return this._views.get(t)}select(t){let e=this.tabs.find(n=>n.name===t)??this.tabs[0];for(let n of this.tabs){let s=n===e,r=this._buttons.get(n.name);r.setAttribute("aria-selected",String(s)),r.tabIndex=s?0:-1,this._panels.get(n.name).hidden=!s,s||this._views.get(n.name)?.hide?.()}this._views.has(e.name)||(this._views.set(e.name,e.mount(this._panels.get(e.name),this)),this._greeting&&this._views.get(e.name).greet?.(this._greeting.desks[e.name]??{})),this.keys.active=e.name,this.remember({tab:e.name}),this._views.get(e.name).show?.()}remember(t){for(let[e,n]of Object.entries(t))n==null?this.address.delete(e):this.address.set(e,String(n));history.replaceState(null,"",`#${this.address}`)}get theme(){return document.documentElement.dataset.theme}_layout(t){this._buttons=new Map,this._panels=new Map;for(let{name:r,title:o}of this.tabs)this._buttons.set(r,_("button",{role:"tab",id:`tab-${r}`,"aria-controls":`panel-${r}`,onclick:()=>this.select(r)},o)),this._panels.set(r,_("section",{role:"tabpanel",id:`panel-${r}`,"aria-labelledby":`tab-${r}`,hidden:!0}));this._status=_("span",{class:"connection",role:"status"},"connecting");let e=_("nav",{role:"tablist","aria-label":"Tabs"},[...this._buttons.values()]);e.addEventListener("keydown",r=>this._moveTab(r)),It(t,_("header",{},_("h1",{},"crowdbot"),e,this._status,_("button",{type:"button",onclick:()=>this._toggleTheme()},"Theme"),_("button",{type:"button","aria-label":"Keys",onclick:()=>this._showKeys()},"?")),_("main",{},[...this._panels.values()]),Mp);let n=this.address.get("theme")??localStorage.getItem("theme"),s=matchMedia("(prefers-color-scheme: dark)").matches?"dark":"light";document.documentElement.dataset.theme=n??s,this.keys.add(null,[["?","Show the keys",()=>this._showKeys()]])}_listen(){this.connection.on("connected",()=>this._tellConnection("connected","")),this.connection.on("lost",()=>this._tellConnection("not connected, trying again","lost")),this.connection.on("hello",t=>{this._greeting=t;for(let[e,n]of this._views)n.greet?.(t.desks[e]??{})})}_tellConnection(t,e){this._status.textContent=t,this._status.className=`connection ${e}`}_moveTab(t){let e={ArrowRight:1,ArrowLeft:-1}[t.key];if(!e)return;let n=this.tabs.map(r=>r.name),s=n[(n.indexOf(this.keys.active)+e+n.length)%n.length];this.select(s),this._buttons.get(s).focus()}_toggleTheme(){let t=this.theme==="dark"?"light":"dark";document.documentElement.dataset.theme=t,localStorage.setItem("theme",t),document.dispatchEvent(new CustomEvent("theme",{detail:t}))}_showKeys(){let t=this.keys.list().map(([e,n])=>_("tr",{},_("td",{},_("kbd",{},wp(e))),_("td",{},n)));De("Keys",_("table",{},_("tbody",{},t)))}};var zy=i=>i===""?void 0:i,dl=class{constructor(t,e){Object.assign(this,{root:t,model:e})}update(){let{model:t}=this,e=document.activeElement?.closest?.(".inspector")?document.activeElement.name:null,n=t.chosen[0]??[],s=t.node(n);if(!s)return It(this.root,_("p",{},"The text is not well-formed XML; correct it in the XML pane."));if(t.chosen.length>1)return this.several();let r=t.kind(n),o=[...r?.attributes??[],...r?.types?.[s.attributes.type]?.attributes??[]];It(this.root,_("h3",{},`<${s.tag}>`),_("p",{class:"note"},r?.about??""),this.problems(n),r?.types?this.type(n,s,r.types):null,o.map(a=>this.control(n,s,a)),this.children(n,r),this.buttons(n,s)),e&&this.root.querySelector(`[name="${CSS.escape(e)}"]`)?.focus()}problems(t){let e=this.model.state.problems.filter(n=>n.path&&n.path.join()===t.join());return e.length?_("ul",{class:"problems"},e.map(n=>_("li",{},n.message))):null}several(){let{model:t}=this,e=t.chosen.every(n=>t.node(n)?.tag==="agent");It(this.root,_("h3",{},`${t.chosen.length} elements`),_("div",{class:"row"},e?_("button",{type:"button",onclick:()=>t.edit("gather",{paths:t.chosen})},"Make a spawner"):null,_("button",{type:"button",onclick:()=>t.edit("remove",{paths:t.chosen})},"Remove")))}type(t,e,n){let r=["",...e.attributes.type in n||!e.attributes.type?[]:[e.attributes.type],...Object.keys(n)],o=_("select",{name:"type",onchange:()=>this.set(t,"type",o.value)},r.map(a=>_("option",{value:a,selected:a===(e.attributes.type??"")},a||"default")));return this.field("type",n[e.attributes.type]?.about,o)}control(t,e,n){let s=e.attributes[n.name],r=l=>this.set(t,n.name,l===void 0||l===""?null:l),o=`${n.label}${n.unit?` [${n.unit}]`:""}${n.required?" *":""}`,a;if(n.kind==="choice"||n.kind==="switch"){let l=n.kind==="switch"?["true","false"]:n.choices,c=s??"";a=_("select",{name:n.name,onchange:()=>r(a.value)},["",...l].map(u=>_("option",{value:u,selected:u===c},u||`default (${n.value})`)))}else{let l=n.kind==="number"||n.kind==="whole";a=_("input",{name:n.name,type:"text",inputmode:l?"decimal":"text",value:s??"",placeholder:n.value===null||n.value===void 0?"":String(n.value),onchange:()=>r(zy(a.value))})}return this.field(o,n.note,a)}field(t,e,n){return _("label",{class:"field",title:e??""},_("span",{},t),n)}set(t,e,n){return this.model.edit("change",{changes:[{path:t,name:e,value:n}]})}children(t,e){let n=Object.keys(e?.children??{});if(!n.length)return null;let s=_("select",{name:"child","aria-label":"Element to add"},n.map(o=>_("option",{},o)));return _("div",{class:"row"},s,_("button",{type:"button",onclick:()=>this.model.insert(t,this.blank(e.children[s.value],s.value))},"Add inside"))}blank(t,e){let n=this.model.table[t],s=(n?.attributes??[]).filter(r=>r.required).map(r=>` ${r.name}="${Hy(r)}"`);return n?.types&&e!=="crowd"&&s.push(` type="${Object.keys(n.types)[0]}"`),e==="crowd"&&s.push(' type="people"'),e==="robot"?`<robot${s.join("")}>
  <goal x="0" y="0"/>
  <drive type="differential-drive"/>
  <navigator type="orca"/>
</robot>`:`<${e}${s.join("")}/>`}buttons(t,e){if(!t.length)return null;let{model:n}=this,s=Number(n.state.tree.attributes.seed??0);return _("div",{class:"row"},e.tag==="spawner"?_("button",{type:"button",onclick:()=>n.edit("expand",{path:t,seed:s})},"Make single people"):null,_("button",{type:"button",onclick:()=>n.edit("remove",{paths:[t]})},"Remove"))}},Hy=i=>i.kind==="points"?"0,0 1,0 1,1 0,1":i.kind==="choice"?i.choices[0]:i.kind==="number"||i.kind==="whole"||i.kind==="distribution"?Math.max(i.low??1,1):i.name==="name"?"new":"";var fl=class extends EventTarget{constructor(t){super(),this.connection=t,this.state=null,this.table=null,this.chosen=[],this.people=null,this.places=!1,t.on("editor.state",e=>this.take(e))}take(t){this.state&&t.revision<this.state.revision||(this.state=t,this.chosen=this.chosen.filter(e=>this.node(e)),this.places||(this.people=null),this.emit("state"),this.places&&!t.problems.length&&this.preview())}emit(t){this.dispatchEvent(new Event(t))}on(t,e){this.addEventListener(t,e)}node(t){return t.reduce((e,n)=>e?.children[n],this.state?.tree??void 0)}kind(t){let e=this.table?.Trial,n=this.state?.tree;for(let s of t)n=n?.children[s],e=this.table?.[e?.children[n?.tag]];return e}choose(t){this.chosen=t,this.emit("chosen")}call(t,e={}){return ve(()=>this.connection.call(`editor.${t}`,e))}async edit(t,e={}){let n=await this.call(t,{...e,revision:this.state.revision});return n&&this.take(n),n}async insert(t,e){await this.edit("insert",{path:t,xml:e})&&this.choose([[...t,this.node(t).children.length-1]])}async step(t,e={}){let n=await this.call(t,e);n&&this.take(n)}async showPlaces(t){if(this.places=t,t)return this.preview();this.people=null,this.emit("people")}async preview(){let t=this.state.revision,e=await this.call("preview");t!==this.state.revision||!this.places||(this.people=e,this.emit("people"))}},cs=(i,t)=>i.length===t.length&&i.every((e,n)=>e===t[n]);var pl=class{constructor(t,e){Object.assign(this,{root:t,model:e}),t.setAttribute("role","listbox"),t.setAttribute("aria-label","Elements"),t.setAttribute("aria-multiselectable","true"),t.tabIndex=0,t.addEventListener("keydown",n=>this.press(n))}update(){let t=this.model.state.tree;this.paths=t?Ep(t):[],It(this.root,this.paths.map((n,s)=>this.row(n,s)));let e=this.paths.findIndex(n=>this.isChosen(n));e>=0&&(this.root.setAttribute("aria-activedescendant",`element-${e}`),this.root.children[e].scrollIntoView({block:"nearest"}))}row(t,e){let n=this.model.node(t),{name:s,type:r,count:o}=n.attributes,a=this.model.state.problems.some(c=>c.path&&cs(c.path,t)),l=[n.tag,s,r,o&&`${o} people`,a&&"has a problem"].filter(Boolean).join(" ");return _("div",{role:"option",id:`element-${e}`,"aria-selected":String(this.isChosen(t)),class:a?"wrong":"",style:`padding-left:${8+14*t.length}px`,onclick:c=>this.choose(t,c.shiftKey||c.ctrlKey)},l)}isChosen(t){return this.model.chosen.some(e=>cs(e,t))}choose(t,e){let n=e?this.model.chosen.filter(s=>!cs(s,t)):[];this.model.choose([...n,t])}press(t){let e=this.paths.findIndex(s=>this.isChosen(s)),n={ArrowDown:e+1,ArrowUp:e-1,Home:0,End:this.paths.length-1}[t.key];n!==void 0&&this.paths[n]?(t.preventDefault(),this.choose(this.paths[n],t.shiftKey)):t.key==="Delete"&&this.model.chosen.some(s=>s.length)&&(t.preventDefault(),this.model.edit("remove",{paths:this.model.chosen.filter(s=>s.length)}))}};function Ep(i,t=[]){return[t,...i.children.flatMap((e,n)=>Ep(e,[...t,n]))]}async function Tp(i,t,e){let n=await i.call("sources");if(!n)return;let s=async u=>{e(),c.close(),await i.step("start",u)},r=(u,d,h)=>_("li",{},_("button",{type:"button",class:"link",onclick:()=>s(h)},u),d&&_("small",{},d)),o=_("input",{type:"search","aria-label":"Filter the trials",placeholder:"filter"}),a=_("ul",{class:"sources"},n.trials.map(u=>r(u.name,u.about,{trial:u.name})));o.addEventListener("input",()=>{for(let u of a.children)u.hidden=!u.textContent.includes(o.value)});let l=_("input",{type:"file",multiple:!0,accept:".xml,.yaml,.pgm,.wkt,.geojson",onchange:()=>Wy(l.files,t,s)}),c=De("Open a trial",_("div",{},_("ul",{class:"sources"},r("Empty trial",null,{}),n.files.map(u=>r(u,"file in the folder of the app",{file:u}))),Dn("Trials (.xml), ROS maps (.yaml with its picture), areas (.wkt, .geojson)",l),Gy(t,i,()=>c.close()),n.maps.length?Vy(n.maps,i,()=>c.close()):null,_("h3",{},"Built-in trials"),o,a),[["Cancel",()=>!0]])}async function Ap(i,t){let e=t.state.tree.children.findIndex(n=>n.tag==="stage");e<0&&await t.edit("insert",{path:[],xml:"<stage/>",position:0}),await t.edit("change",{changes:[{path:[Math.max(e,0)],name:"map",value:i}]})}function Gy(i,t,e){let n=_("input",{type:"number",min:"0.001",max:"10",step:"0.001",value:"0.05"}),s=_("input",{type:"file",accept:".png,.jpg,.jpeg"}),r=async()=>{let[o]=await Rp(s.files,i),a=o&&await t.call("floor",{picture:o,resolution:Number(n.value)});a&&(e(),await Ap(a,t))};return _("fieldset",{},_("legend",{},"Stage from a picture of a floor plan: dark pixels are walls"),Dn("Picture (.png, .jpg)",s),Dn("Size of a pixel [m]",n),_("button",{type:"button",onclick:r},"Use as stage"))}function Vy(i,t,e){let n=s=>(e(),Ap(s,t));return _("ul",{class:"sources"},i.map(s=>_("li",{},_("button",{type:"button",class:"link",onclick:()=>n(s)},`Use the map ${s} as stage`))))}async function Rp(i,t){let e=[];for(let n of i){let s=`api/${t.connection.session}/upload?${new URLSearchParams({name:n.name})}`,r=await ve(async()=>{let o=await fetch(s,{method:"POST",body:n});if(!o.ok)throw new Error((await o.text()).trim());return o.json()});if(!r)break;e.push(r.name)}return e}async function Wy(i,t,e){for(let n of await Rp(i,t))Te(`${n} is in the folder of the app`),n.endsWith(".xml")&&await e({file:n})}function Cp(i){let t=_("input",{type:"text",value:i.state.file||"new-trial.xml"});De("Save the trial",Dn("Name in the folder of the app",t),[["Cancel",()=>!0],["Save",async()=>{let e=await i.call("save",{file:t.value});return e?(i.take(e),Te(`saved as ${e.file}`),!0):!1}]])}var tn=(i,t=0)=>{let e=Number.parseFloat(i);return Number.isFinite(e)?e:t};function gl(i){return(i??"").trim().replace(/\s*,\s*/g,",").split(/\s+/).map(t=>t.split(",").map(Number)).filter(t=>t.length===2&&t.every(Number.isFinite))}var Nn=i=>String(Math.round(i*1e3)/1e3),Qn=i=>i.map(([t,e])=>`${Nn(t)},${Nn(e)}`).join(" "),Pp={wall:[["points",!1,"wall"]],obstacle:[["points",!0,"solid"]],stage:[["walkable",!0,"ground"]],door:[["points",!1,"door"]],spawner:[["zone",!0,"people"],["goal",!0,"goal"]],source:[["zone",!0,"people"],["goal",!0,"goal"]],exit:[["zone",!0,"exit"]],portal:[["zone",!0,"exit"]],zone:[["points",!0,"goal"]],agent:[["goal-zone",!0,"goal"],["goal",!1,"target"]]},vu={cube:i=>[tn(i.size,.5),tn(i.size,.5)],table:i=>[tn(i.length,1.6),tn(i.width,.8)],ramp:i=>[tn(i.length,1),tn(i.width,1.5)],platform:i=>[tn(i.length,1),tn(i.width,1)],threshold:i=>[tn(i.depth,.1),tn(i.width,1)],stairs:i=>[tn(i.steps,1)*tn(i.tread,.29),tn(i.width,1.5)]},Ip={tree:i=>[tn(i.trunk,.15),"solid"],light:()=>[.15,"light"],agent:i=>[tn(i.radius,.25),"person"],avatar:i=>[tn(i.radius,.25),"person"],robot:i=>[tn(i.radius,.3),"robot"],goal:i=>[tn(i.tolerance,.3),"target"],point:i=>[tn(i.tolerance,.3),"target"],camera:()=>[.2,"camera"]},Xy=new Set(["robot","agent","camera","avatar","ramp","stairs","cube","table"]);function bu(i,t=[]){let e=[],n=i.tag==="camera"&&i.attributes.robot;for(let[r,o,a]of Pp[i.tag]??[]){let l=gl(i.attributes[r]);l.length&&e.push({path:t,tag:i.tag,style:a,points:l,closed:o,attribute:r})}vu[i.tag]?e.push(qy(i,t)):Ip[i.tag]&&"x"in i.attributes&&!n&&e.push($y(i,t));let s=i.children.flatMap((r,o)=>bu(r,[...t,o]));return[...e,...s]}function $y(i,t){let[e,n]=Ip[i.tag](i.attributes),s=Xy.has(i.tag)&&"heading"in i.attributes?tn(i.attributes.heading):null;return{path:t,tag:i.tag,style:n,centre:ml(i),radius:e,heading:s,points:[ml(i)],closed:!1}}function qy(i,t){let[e,n]=vu[i.tag](i.attributes),s=tn(i.attributes.heading),[r,o]=ml(i),[a,l]=[Math.cos(s),Math.sin(s)],c=[[1,1],[-1,1],[-1,-1],[1,-1]].map(([u,d])=>[r+(a*u*e-l*d*n)/2,o+(l*u*e+a*d*n)/2]);return{path:t,tag:i.tag,style:"prop",points:c,closed:!0,centre:[r,o],heading:s}}var ml=i=>[tn(i.attributes.x),tn(i.attributes.y)];function Su(i,t,e,n){let s=[];if("x"in i.attributes||vu[i.tag]||i.tag==="robot"||i.tag==="agent"){let[o,a]=ml(i);return s.push({path:t,name:"x",value:Nn(o+e)},{path:t,name:"y",value:Nn(a+n)}),s}let[[r]=[]]=Pp[i.tag]??[];if(r){let o=gl(i.attributes[r]).map(([a,l])=>[a+e,l+n]);s.push({path:t,name:r,value:Qn(o)})}return s}function Lp(i,t,e,n,s){let r=gl(i.attributes[e]).map(([o,a])=>[o+n,a+s]);return[{path:t,name:e,value:Qn(r)}]}function Dp(i,t,e,n,s){let r=gl(i.attributes[e]);return r[n]=s,[{path:t,name:e,value:Qn(r)}]}function Np(i,t=[]){let e=[...i.flatMap(r=>r.points),...t];if(!e.length)return[-5,-5,5,5];let n=e.map(r=>r[0]),s=e.map(r=>r[1]);return[Math.min(...n)-1,Math.min(...s)-1,Math.max(...n)+1,Math.max(...s)+1]}var Is=([i,t])=>`x="${Nn(i)}" y="${Nn(t)}"`,qo=([i,t],[e,n])=>[[Math.min(i,e),Math.min(t,n)],[Math.max(i,e),Math.min(t,n)],[Math.max(i,e),Math.max(t,n)],[Math.min(i,e),Math.max(t,n)]],Mu=(i,t,e)=>{let n=new Set(i.children.filter(r=>r.tag===t).map(r=>r.attributes.name||e));if(!n.has(e))return e;let s=2;for(;n.has(`${e}${s}`);)s++;return`${e}${s}`},wu=[{name:"wall",title:"Wall",key:"w",mode:"line",into:"stage",xml:i=>`<wall points="${Qn(i)}"/>`},{name:"obstacle",title:"Obstacle",key:"o",mode:"area",into:"stage",xml:i=>`<obstacle points="${Qn(i)}"/>`},{name:"walkable",title:"Walkable area",key:"g",mode:"area",attribute:["stage","walkable"]},{name:"spawner",title:"People",key:"p",mode:"two-areas",xml:i=>`<spawner count="5" zone="${Qn(i[0])}" goal="${Qn(i[1])}"/>`},{name:"source",title:"Source",key:"s",mode:"two-areas",xml:i=>`<source rate="0.5" zone="${Qn(i[0])}" goal="${Qn(i[1])}"/>`},{name:"agent",title:"Person",key:"a",mode:"arrow",xml:([i,t])=>`<agent ${Is(i)} goal="${Qn([t])}"/>`},{name:"robot",title:"Robot",key:"r",mode:"arrow",xml:([i,t],e)=>`<robot name="${Mu(e,"robot","robot")}" ${Is(i)} heading="${Nn(Math.atan2(t[1]-i[1],t[0]-i[0]))}">
  <goal ${Is(t)}/>
  <drive type="differential-drive"/>
  <navigator type="orca"/>
  <sensor type="lidar2d"/>
</robot>`},{name:"exit",title:"Exit",key:"e",mode:"area",xml:i=>`<exit zone="${Qn(i)}"/>`},{name:"portal",title:"Portal",key:"b",mode:"two-areas",xml:([i,t])=>`<portal zone="${Qn(i)}" dx="${Nn(t[0][0]-i[0][0])}" dy="${Nn(t[0][1]-i[0][1])}"/>`},{name:"cube",title:"Cube",key:"c",mode:"point",into:"stage",xml:([i])=>`<cube ${Is(i)}/>`},{name:"table",title:"Table",key:"t",mode:"point",into:"stage",xml:([i])=>`<table ${Is(i)}/>`},{name:"tree",title:"Tree",key:"v",mode:"point",into:"stage",xml:([i])=>`<tree ${Is(i)}/>`},{name:"light",title:"Light",key:"l",mode:"point",into:"stage",xml:([i])=>`<light ${Is(i)}/>`},{name:"door",title:"Door",key:"d",mode:"arrow",into:"stage",xml:(i,t)=>`<door name="${Mu(Yy(t)??t,"door","door")}" points="${Qn(i)}"/>`},{name:"camera",title:"Camera",key:"m",mode:"arrow",xml:([i,t],e)=>`<camera name="${Mu(e,"camera","camera")}" ${Is(i)} heading="${Nn(Math.atan2(t[1]-i[1],t[0]-i[0]))}"/>`}],Yy=i=>i.children.find(t=>t.tag==="stage"),Eu=i=>({line:1/0,area:2,"two-areas":4,point:1,arrow:2})[i.mode];function Up(i,t){return i.mode==="line"?t<2?"Click the corners of the line":"Click more corners, or press Enter":i.mode==="point"?"Click the place":i.mode==="arrow"?t?"Click where it goes or looks":"Click the place":i.mode==="area"?t?"Click the opposite corner":"Click a corner":["Click a corner of the first zone","Click its opposite corner","Click a corner of the second zone","Click its opposite corner"][t]}async function Tu(i,t,e){let n=e.state.tree.children.findIndex(o=>o.tag==="stage");if(i.into==="stage"&&n<0)return await e.edit("insert",{path:[],xml:"<stage/>",position:0}),Tu(i,t,e);let s=i.mode==="area"?qo(t[0],t[1]):t,r=i.mode==="two-areas"?[qo(t[0],t[1]),qo(t[2],t[3])]:s;if(i.attribute){n<0&&await e.edit("insert",{path:[],xml:"<stage/>",position:0});let o=[Math.max(n,0)];return e.edit("change",{changes:[{path:o,name:i.attribute[1],value:Qn(s)}]})}return e.insert(i.into==="stage"?[n]:[],i.xml(r,e.state.tree))}var Fp={ground:{fill:"--panel",stroke:"--line",dash:[]},wall:{stroke:"--ink",width:3,dash:[]},solid:{fill:"--line",stroke:"--ink",dash:[]},prop:{fill:"--line",stroke:"--faint",dash:[]},door:{stroke:"--data-5",width:4,dash:[]},people:{stroke:"--data-1",dash:[]},goal:{stroke:"--data-3",dash:[6,4]},target:{stroke:"--data-3",dash:[2,3]},exit:{stroke:"--data-4",dash:[10,4]},person:{fill:"--data-1",stroke:"--ink",dash:[]},robot:{fill:"--data-2",stroke:"--ink",dash:[]},camera:{stroke:"--data-4",dash:[]},light:{fill:"--data-5",stroke:"--ink",dash:[]}},Op=9,_l=class{constructor(t,e,n){Object.assign(this,{canvas:t,model:e,tell:n,tool:null,points:[],pointer:null,drag:null,snap:.1}),this.scale=30,this.origin=[0,0],this.shapes=[],this.fitted=!1,new ResizeObserver(()=>this.resize()).observe(t),t.addEventListener("pointerdown",s=>this.press(s)),t.addEventListener("pointermove",s=>this.move(s)),t.addEventListener("pointerup",s=>this.release(s)),t.addEventListener("dblclick",()=>this.end()),t.addEventListener("wheel",s=>this.zoom(s),{passive:!1}),document.addEventListener("theme",()=>this.draw())}update(){this.shapes=this.model.state.tree?bu(this.model.state.tree):this.shapes,!this.fitted&&this.canvas.clientWidth&&this.fit(),this.draw()}fit(){let[t,e,n,s]=Np([...this.shapes,...this.model.state.rings.map(a=>({points:a}))]),{clientWidth:r,clientHeight:o}=this.canvas;this.scale=Math.min(r/(n-t),o/(s-e),200),this.origin=[r/2-(t+n)/2*this.scale,o/2+(e+s)/2*this.scale],this.fitted=!0,this.draw()}resize(){let t=window.devicePixelRatio||1;this.canvas.width=Math.round(this.canvas.clientWidth*t),this.canvas.height=Math.round(this.canvas.clientHeight*t),this.model.state&&!this.fitted?this.fit():this.draw()}use(t){this.tool=t,this.points=[],this.draw()}pixel([t,e]){return[this.origin[0]+t*this.scale,this.origin[1]-e*this.scale]}place(t){let e=this.canvas.getBoundingClientRect(),[n,s]=[t.clientX-e.left,t.clientY-e.top];return[(n-this.origin[0])/this.scale,(this.origin[1]-s)/this.scale]}snapped([t,e],n=null){let s=Op/this.scale;for(let r of this.shapes){if(n&&cs(r.path,n))continue;let o=r.points.find(a=>Math.hypot(a[0]-t,a[1]-e)<s);if(o&&r.style!=="target")return o}return this.snap?[t,e].map(r=>Math.round(r/this.snap)*this.snap):[t,e]}press(t){if(!this.model.state?.tree)return;this.canvas.setPointerCapture(t.pointerId);let e=this.place(t);if(t.button===1||t.button===2)this.drag={kind:"pan",from:[t.clientX,t.clientY],origin:this.origin};else if(this.tool)this.points.push(this.snapped(e)),this.points.length>=Eu(this.tool)&&this.end();else if(this.drag=this.grab(e)??{kind:"pan",from:[t.clientX,t.clientY],origin:this.origin},this.drag.shape){let n=t.shiftKey?this.model.chosen.filter(s=>!cs(s,this.drag.shape.path)):[];this.model.choose([...n,this.drag.shape.path])}else this.model.choose([]);this.draw()}grab(t){let e=Op/this.scale;for(let n of this.shapes){if(!this.isChosen(n)||!n.attribute)continue;let s=n.points.findIndex(r=>Math.hypot(r[0]-t[0],r[1]-t[1])<e);if(s>=0)return{kind:"corner",shape:n,index:s,from:t,at:t}}for(let n of[...this.shapes].reverse())if(this.touches(n,t,e))return{kind:"move",shape:n,from:t,at:t};return null}touches(t,[e,n],s){if(t.radius)return Math.hypot(t.centre[0]-e,t.centre[1]-n)<Math.max(t.radius,s);let r=t.closed?[...t.points,t.points[0]]:t.points;for(let o=1;o<r.length;o++)if(Zy([e,n],r[o-1],r[o])<s)return!0;return r.length===1?Math.hypot(r[0][0]-e,r[0][1]-n)<s:t.closed&&t.style!=="ground"&&Ky([e,n],t.points)}isChosen(t){return this.model.chosen.some(e=>cs(e,t.path))}move(t){if(!this.model.state?.tree)return;let e=this.place(t);if(this.pointer=this.snapped(e,this.drag?.shape?.path),this.drag?.kind==="pan"){let[n,s]=this.drag.from;this.origin=[this.drag.origin[0]+t.clientX-n,this.drag.origin[1]+t.clientY-s]}else this.drag&&(this.drag.at=this.drag.kind==="corner"?this.pointer:e);this.tell(this.words()),this.draw()}words(){let t=this.points.at(-1);if(this.tool&&t){let[e,n]=[this.pointer[0]-t[0],this.pointer[1]-t[1]];return this.tool.mode.includes("area")&&this.points.length%2?`${Nn(Math.abs(e))} m x ${Nn(Math.abs(n))} m`:`${Nn(Math.hypot(e,n))} m`}return this.drag?.shape?`moved by ${this.offset().map(Nn).join(", ")} m`:`x ${Nn(this.pointer[0])} m, y ${Nn(this.pointer[1])} m`}offset(){let t=[this.drag.at[0]-this.drag.from[0],this.drag.at[1]-this.drag.from[1]];return this.snap&&this.drag.kind==="move"?t.map(e=>Math.round(e/this.snap)*this.snap):t}async release(){let t=this.drag;if(this.drag=null,!t?.shape)return;this.drag=t;let[e,n]=this.offset();if(this.drag=null,!e&&!n)return this.draw();await this.model.edit("change",{changes:this.changes(t,e,n)}),this.draw()}changes({kind:t,shape:e,index:n,at:s},r,o){let a=this.model.node(e.path);return t==="corner"?Dp(a,e.path,e.attribute,n,s):this.model.chosen.length>1&&this.isChosen(e)?this.model.chosen.flatMap(c=>Su(this.model.node(c),c,r,o)):e.attribute?Lp(a,e.path,e.attribute,r,o):Su(a,e.path,r,o)}async end(){let{tool:t,points:e}=this;if(!t)return;let n=e.filter((r,o)=>o===0||Math.hypot(r[0]-e[o-1][0],r[1]-e[o-1][1])>1e-9);(t.mode==="line"?n.length>=2:e.length>=Eu(t))&&(this.points=[],await Tu(t,t.mode==="line"?n:e,this.model))}cancel(){this.points=[],this.draw()}zoom(t){t.preventDefault();let e=this.place(t),n=this.pixel(e);this.scale=Math.min(400,Math.max(1,this.scale*Math.exp(-t.deltaY/600)));let s=this.pixel(e);this.origin=[this.origin[0]+n[0]-s[0],this.origin[1]+n[1]-s[1]],this.draw()}draw(){let t=this.canvas.getContext("2d"),e=getComputedStyle(document.documentElement);this.colour=s=>e.getPropertyValue(s).trim();let n=window.devicePixelRatio||1;t.setTransform(n,0,0,n,0,0),t.clearRect(0,0,this.canvas.clientWidth,this.canvas.clientHeight),this.drawGrid(t);for(let s of this.model.state?.rings??[])this.line(t,s,!0,Fp.solid);for(let s of this.shapes)this.drawShape(t,s);this.drawPeople(t),this.drawPoints(t)}drawGrid(t){let e=[.1,.5,1,5,10,50].find(r=>r*this.scale>=18)??100;t.strokeStyle=this.colour("--line"),t.globalAlpha=.35,t.lineWidth=1,t.beginPath();let{clientWidth:n,clientHeight:s}=this.canvas;for(let r=this.origin[0]%(e*this.scale);r<n;r+=e*this.scale)t.rect(r,0,0,s);for(let r=this.origin[1]%(e*this.scale);r<s;r+=e*this.scale)t.rect(0,r,n,0);t.stroke(),t.globalAlpha=1}drawShape(t,e){let n=this.isChosen(e),s=this.model.state.problems.some(c=>c.path&&cs(c.path,e.path)),r={...Fp[e.style]};s&&(r.stroke="--danger"),n&&Object.assign(r,{width:(r.width??1.5)+2,stroke:s?"--danger":"--focus"});let[o,a]=n&&this.drag?.kind==="move"?this.offset():[0,0];if(e.radius){this.disc(t,[e.centre[0]+o,e.centre[1]+a],e,r);return}let l=e.points.map(([c,u])=>[c+o,u+a]);if(this.drag?.kind==="corner"&&this.drag.shape===e&&(l[this.drag.index]=this.drag.at),this.line(t,l,e.closed,r),n&&e.attribute)for(let c of l)this.handle(t,c)}line(t,e,n,s){t.beginPath(),e.forEach((r,o)=>t[o?"lineTo":"moveTo"](...this.pixel(r))),n&&t.closePath(),this.paint(t,s,n),e.length===1&&this.handle(t,e[0])}disc(t,e,n,s){let[r,o]=this.pixel(e),a=Math.max(n.radius*this.scale,4);t.beginPath(),t.arc(r,o,a,0,2*Math.PI),this.paint(t,s,!0),n.heading!==null&&(t.beginPath(),t.moveTo(r,o),t.lineTo(r+2*a*Math.cos(n.heading),o-2*a*Math.sin(n.heading)),t.stroke())}paint(t,e,n){t.setLineDash(e.dash??[]),t.lineWidth=e.width??1.5,t.strokeStyle=this.colour(e.stroke),n&&e.fill&&(t.fillStyle=this.colour(e.fill),t.globalAlpha=.7,t.fill(),t.globalAlpha=1),t.stroke(),t.setLineDash([])}handle(t,e){let[n,s]=this.pixel(e);t.fillStyle=this.colour("--focus"),t.fillRect(n-4,s-4,8,8)}drawPeople(t){let e=this.model.people;if(e){t.globalAlpha=.6;for(let n of e.ways)this.line(t,n,!1,{stroke:"--data-3",width:1,dash:[3,3]});e.people.forEach((n,s)=>this.disc(t,n,{radius:e.radii[s],heading:null},{fill:"--data-1",stroke:"--ink"})),t.globalAlpha=1}}drawPoints(t){if(!this.tool||!this.pointer)return;let e={stroke:"--focus",width:2,dash:[4,3]},n=[...this.points,this.pointer];if(!this.tool.mode.includes("area")){this.line(t,n,!1,e);return}for(let s=0;s<n.length;s+=2)n[s+1]&&this.line(t,qo(n[s],n[s+1]),!0,e)}};function Zy([i,t],[e,n],[s,r]){let[o,a]=[s-e,r-n],l=Math.max(0,Math.min(1,((i-e)*o+(t-n)*a)/(o*o+a*a||1)));return Math.hypot(i-e-l*o,t-n-l*a)}function Ky([i,t],e){let n=!1;for(let s=0,r=e.length-1;s<e.length;r=s++){let[[o,a],[l,c]]=[e[s],e[r]];a>t!=c>t&&i<(l-o)*(t-a)/(c-a)+o&&(n=!n)}return n}var Jy=400,yl=class{constructor(t,e){Object.assign(this,{model:e,timer:0}),this.numbers=_("pre",{class:"numbers","aria-hidden":"true"}),this.area=_("textarea",{spellcheck:"false","aria-label":"XML of the trial",wrap:"off",oninput:()=>this.wait()}),this.area.addEventListener("scroll",()=>this.numbers.scrollTop=this.area.scrollTop),this.area.addEventListener("blur",()=>this.send()),t.append(this.numbers,this.area)}update(){if(!this.timer){if(this.area.value!==this.model.state.text){let t=this.area.selectionStart;this.area.value=this.model.state.text,this.area.setSelectionRange(t,t)}this.count()}}count(){let t=new Set(this.model.state.problems.map(n=>n.line)),e=this.area.value.split(`
`).length;this.numbers.textContent=Array.from({length:e},(n,s)=>`${t.has(s+1)?"!":" "}${s+1}`).join(`
`)}show(t){let e=this.area.value.split(`
`),n=e.slice(0,t-1).join(`
`).length+(t>1?1:0);this.area.focus(),this.area.setSelectionRange(n,n+(e[t-1]??"").length),this.area.scrollTop=Math.max(0,(t-4)*18)}wait(){clearTimeout(this.timer),this.timer=setTimeout(()=>this.send(),Jy),this.count()}async send(){if(!this.timer)return;clearTimeout(this.timer);let t=this.area.value,e=await this.model.edit("write",{text:t});this.area.value===t&&(this.timer=0,e||this.model.emit("conflict"))}async resolve(t){t?await this.model.edit("write",{text:this.area.value}):this.area.value=this.model.state.text,this.update()}};var jy=[["0.1","0.1 m"],["0.25","0.25 m"],["0.5","0.5 m"],["1","1 m"],["0","off"]],Au=class{constructor(t,e){this.app=e,this.model=new fl(e.connection),this.layout(t),this.model.on("state",()=>this.update()),this.model.on("chosen",()=>this.updateChosen()),this.model.on("people",()=>this.view.draw()),this.model.on("conflict",()=>this.askConflict()),this.addKeys()}layout(t){let e=_("canvas",{tabindex:"0","aria-label":"Trial from above; the list of elements has the same content"});this.words=_("span",{class:"words"}),this.summary=_("p",{class:"note","aria-live":"polite"}),this.view=new _l(e,this.model,r=>this.words.textContent=r),e.addEventListener("contextmenu",r=>r.preventDefault()),e.addEventListener("pointerup",()=>this.tellTool());let n={outline:_("div",{class:"outline"}),inspector:_("div",{class:"inspector"}),xml:_("div",{class:"xml"})};this.outline=new pl(n.outline,this.model),this.inspector=new dl(n.inspector,this.model),this.xml=new yl(n.xml,this.model),this.problems=_("ul",{class:"problems","aria-label":"Problems"});let s=_("div",{class:"text"},_("h2",{},"XML"),n.xml);t.classList.add("editor"),It(t,_("div",{class:"bar"},this.fileButtons(),this.tools(),this.grid()),_("div",{class:"left"},_("h2",{},"Elements"),n.outline,this.summary),_("div",{class:"middle"},_("div",{class:"view"},e,this.words),_("div",{class:"below"},this.problems,s)),_("div",{class:"right"},_("h2",{},"Chosen element"),n.inspector))}fileButtons(){let t=(e,n,s={})=>_("button",{type:"button",onclick:n,...s},e);return this.undo=t("Undo",()=>this.model.step("undo")),this.redo=t("Redo",()=>this.model.step("redo")),this.places=t("Places",()=>this.togglePlaces(),{title:"Show where people start and walk","aria-pressed":"false"}),this.run=t("Run",()=>this.runTrial(),{class:"main"}),_("span",{class:"row"},t("Open",()=>Tp(this.model,this.app,()=>this.view.fitted=!1)),t("Save",()=>Cp(this.model)),this.undo,this.redo,this.places,t("Whole view",()=>this.view.fit()),this.run)}togglePlaces(){let t=!this.model.places;return this.places.setAttribute("aria-pressed",String(t)),this.model.showPlaces(t)}tools(){this.toolButtons=new Map;let t=(e,n,s,r)=>{let o=_("button",{type:"button",title:`${n} (${s})`,"aria-pressed":String(!r),onclick:()=>this.use(r)},n);return this.toolButtons.set(e,o),o};return _("span",{class:"row",role:"toolbar","aria-label":"Tools"},t("select","Select","Esc",null),wu.map(e=>t(e.name,e.title,e.key,e)))}grid(){let t=_("select",{onchange:()=>this.view.snap=Number(t.value)},jy.map(([e,n])=>_("option",{value:e},n)));return _("label",{class:"row"},"Grid",t)}use(t){this.view.use(t);for(let[e,n]of this.toolButtons)n.setAttribute("aria-pressed",String(e===(t?.name??"select")));this.tellTool()}tellTool(){this.view.tool&&(this.words.textContent=Up(this.view.tool,this.view.points.length))}addKeys(){let{keys:t}=this.app;t.add("editor",[["Escape","Select; cancel a drawing",()=>this.view.points.length?this.view.cancel():this.use(null)],["Enter","End a line",()=>this.view.end()],["Delete","Remove the chosen elements",()=>this.model.chosen.length&&this.model.edit("remove",{paths:this.model.chosen})],["u","Undo",()=>this.model.step("undo")],["U","Redo",()=>this.model.step("redo")],["f","Whole view",()=>this.view.fit()],...wu.map(e=>[e.key,`Draw: ${e.title}`,()=>this.use(e)])])}update(){let{state:t}=this.model;this.undo.disabled=!t.undo,this.redo.disabled=!t.redo,this.run.disabled=t.problems.length>0,this.outline.update(),this.inspector.update(),this.xml.update(),this.view.update(),this.updateProblems(t),this.summarize(t)}updateChosen(){this.outline.update(),this.inspector.update(),this.view.draw()}updateProblems(t){let e=r=>{r.path&&this.model.choose([r.path]),r.line&&this.xml.show(r.line)},n=r=>_("li",{},_("button",{type:"button",class:"link",onclick:()=>e(r)},r.message)),s=t.problems.length?[]:[_("li",{class:"good"},"No errors")];It(this.problems,t.problems.map(n),s,t.remarks.map(r=>_("li",{class:"note"},r)))}summarize({tree:t,file:e,problems:n}){let s=l=>t?.children.filter(c=>c.tag===l).length??0,r=t?.children.filter(l=>l.tag==="spawner").reduce((l,c)=>l+(Number(c.attributes.count)||0),s("agent"))??0,o=(l,c,u)=>`${l} ${l===1?c:u}`,a=`${o(r,"person","people")}, ${o(s("robot"),"robot","robots")}`;this.summary.textContent=`${e||"not saved"}: ${a}, ${o(n.length,"problem","problems")}`}async runTrial(){let t=this.model.state.file||"new-trial.xml",e=await this.model.call("save",{file:t});e&&(this.model.take(e),this.app.select("simulator"),document.dispatchEvent(new CustomEvent("open-trial",{detail:{file:e.file}})))}askConflict(){De("The trial was changed in another window",_("p",{},"Your text is still in the XML pane. Which one stays?"),[["The other one",()=>{this.xml.resolve(!1)}],["My text",()=>{this.xml.resolve(!0)}]])}async greet(t){this.model.table||(this.model.table=await this.model.call("table")),this.model.state=null,"revision"in t?this.model.take(t):Te("the editor has no state","error")}},kp={name:"editor",title:"Editor",mount(i,t){let e=new Au(i,t);return{tab:e,greet:n=>e.greet(n),show:()=>e.view.resize()}}};var Qy="http://www.w3.org/2000/svg";var tx={success:"circle",collision:"cross",timeout:"square"};function Ls(i,t,...e){let n=document.createElementNS(Qy,i);for(let[s,r]of Object.entries(t))s.startsWith("on")?n.addEventListener(s.slice(2),r):n.setAttribute(s,r);return n.append(...e),n}function Bp(i,t,e,n){let s=i.flatMap(u=>u.runs.map(d=>d.values[t])).filter(u=>u!==null),r=Math.min(0,...s),o=Math.max(...s,r+1e-9),a=u=>190+510*(u-r)/(o-r),l=i.length*26+30,c=Ls("svg",{viewBox:`0 0 720 ${l}`,class:"strips",role:"group","aria-label":`Runs by ${e}`});i.forEach((u,d)=>{let h=d*26+13;c.append(Ls("text",{x:180,y:h+4,"text-anchor":"end"},`${u.trial} ${u.navigator}`.slice(0,30))),c.append(Ls("line",{x1:190,x2:700,y1:h,y2:h,class:"axis"}));for(let f of u.runs)f.values[t]!==null&&c.append(ex(u,f,a(f.values[t]),h,n))});for(let u of[r,(r+o)/2,o])c.append(Ls("text",{x:a(u),y:l-8,"text-anchor":"middle"},u.toPrecision(3)));return c}function ex(i,t,e,n,s){let r=tx[t.outcome]??"cross",a={circle:()=>Ls("circle",{cx:e,cy:n,r:4}),square:()=>Ls("rect",{x:e-4,y:n-4,width:8,height:8}),cross:()=>Ls("path",{d:`M${e-4} ${n-4}L${e+4} ${n+4}M${e+4} ${n-4}L${e-4} ${n+4}`})}[r]();return a.setAttribute("class",`mark ${r}`),a.addEventListener("click",()=>s(i.number,t.seed)),a.append(Ls("title",{},`seed ${t.seed}: ${t.outcome}`)),a}var nx=new Set(["success"]),Ru=class{constructor(t,e){Object.assign(this,{app:e,table:null,chosen:null,onlyFailures:!0,statistic:3}),this.side=_("aside",{"aria-label":"Evaluations"}),this.main=_("div",{class:"results"},_("p",{class:"note"},"Run an evaluation, or choose one of the list.")),t.classList.add("evaluation"),It(t,this.side,this.main),e.connection.on("evaluation.state",n=>this.update(n)),e.connection.on("evaluation.progress",n=>this.progress(n)),this.form()}call(t,e={}){return ve(()=>this.app.connection.call(`evaluation.${t}`,e))}form(){this.trials=_("select",{multiple:!0,size:8}),this.navigators=_("input",{type:"text",value:"straight, orca"}),this.known=_("small",{}),this.seeds=_("input",{type:"text",value:"0:20"}),this.safety=_("input",{type:"checkbox"}),this.label=_("input",{type:"text",value:"first"}),this.runButton=_("button",{type:"submit",class:"main"},"Run"),this.cancel=_("button",{type:"button",hidden:!0,onclick:()=>this.call("cancel")},"Cancel"),this.bar=_("progress",{max:1,value:0,hidden:!0,"aria-label":"Progress of the evaluation"}),this.note=_("p",{class:"note","aria-live":"polite"}),this.list=_("ul",{class:"sources"});let t=e=>{e.preventDefault(),this.start()};It(this.side,_("h2",{},"New evaluation"),_("form",{onsubmit:t},Dn("Trials",this.trials),Dn("Navigators",this.navigators),this.known,Dn("Seeds",this.seeds),_("label",{class:"option"},this.safety,"Each also with a safety layer"),Dn("Name",this.label),_("div",{class:"row"},this.runButton,this.cancel)),this.bar,this.note,_("h2",{},"Evaluations"),this.list)}async greet(t){this.update(t);let e=await this.call("sources");if(!e)return;let n=new Set([...this.trials.selectedOptions].map(r=>r.value)),s=[...e.files,...e.trials.map(r=>r.name)];It(this.trials,s.map(r=>_("option",{selected:n.size?n.has(r):r==="frontal"},r))),this.known.textContent=`With parameters, such as "orca safety=0.2". Built-in: ${e.navigators.join(", ")}`}async start(){let t=[...this.trials.selectedOptions].map(s=>s.value),e={name:this.label.value,trials:t,navigators:this.navigators.value,seeds:this.seeds.value,safety:this.safety.checked},n=await this.call("run",e);n&&this.update(n)}update(t){let e=this.state;this.state=t;let n=!!t.running;this.runButton.disabled=n,this.cancel.hidden=!n,this.bar.hidden=!n,this.bar.value=t.share,this.note.textContent=n?`${t.running} is running`:t.problem;let s=({name:r,done:o})=>_("li",{},_("button",{type:"button",class:"link",disabled:!o,onclick:()=>this.open(r)},r),o?null:_("small",{},"not complete; run it again with the same name to continue"));It(this.list,t.evaluations.map(s)),e?.running&&!n&&!t.problem&&this.open(e.running)}progress(t){this.bar.value=t}async open(t){let e=await this.call("table",{name:t});e&&(this.table=e,this.chosen=null,this.statistic=this.mostKnown(),this.show())}mostKnown(){let{statistics:t,cells:e}=this.table,n=r=>e.flatMap(o=>o.runs).filter(o=>o.values[r]!==null).length,s=t.map((r,o)=>r.endsWith("-rate")?0:n(o));return s.indexOf(Math.max(...s))}show(){let{table:t}=this,e=_("select",{onchange:()=>(this.statistic=Number(e.value),this.show())},t.statistics.map((s,r)=>_("option",{value:r,selected:r===this.statistic},s))),n=this.app.connection.address("evaluation",`${t.name}/report.html`);It(this.main,_("h2",{},t.name),_("p",{class:"note"},_("code",{},t.command)),this.rows(),_("ul",{class:"comparisons"},t.comparisons.map(s=>_("li",{},s))),_("div",{class:"row"},Dn("Picture of each run by",e),t.report?_("a",{href:n,target:"_blank",rel:"noopener"},"Report"):null),Bp(t.cells,this.statistic,t.statistics[this.statistic],(s,r)=>this.watch(s,r)),_("p",{class:"note"},"Circle: success. Cross: collision or error. Square: timeout. Choose a mark to watch the run."),this.runs())}rows(){let{cells:t,statistics:e}=this.table,n=["Trial","Navigator","Robot","Visible","Senses",...e,"Runs"],s=r=>_("tr",{"aria-selected":String(r.number===this.chosen)},[r.trial,r.navigator,r.robot,r.visible?"yes":"no",r.senses.join(", ")||"true people"].map(o=>_("td",{},o)),r.estimates.map(o=>_("td",{class:"number"},o)),_("td",{},_("button",{type:"button",onclick:()=>this.choose(r.number)},`${r.runs.length} runs`)));return _("div",{class:"scroll",tabindex:"0",role:"region","aria-label":"Table"},_("table",{},_("thead",{},_("tr",{},n.map(r=>_("th",{scope:"col"},r)))),_("tbody",{},t.map(s))))}choose(t){this.chosen=t,this.show()}runs(){if(this.chosen===null)return null;let t=this.table.cells[this.chosen],e=t.runs.filter(a=>!nx.has(a.outcome)),n=this.onlyFailures&&e.length?e:t.runs,s=_("input",{type:"checkbox",checked:this.onlyFailures,onchange:()=>(this.onlyFailures=s.checked,this.show())}),r=["Seed","Outcome",...this.table.statistics,"Message",""],o=a=>_("tr",{},_("td",{class:"number"},String(a.seed)),_("td",{},a.outcome),a.values.map(l=>_("td",{class:"number"},l===null?"-":l.toPrecision(3))),_("td",{},a.message),_("td",{},_("button",{type:"button",onclick:()=>this.watch(t.number,a.seed)},`Watch seed ${a.seed}`)));return _("div",{},_("h3",{},`${t.trial}, ${t.navigator}`),_("label",{class:"option"},s,`Only the ${e.length} failures`),_("table",{},_("thead",{},_("tr",{},r.map(a=>_("th",{scope:"col"},a||"Watch")))),_("tbody",{},n.slice(0,500).map(o))))}async watch(t,e){let n=await this.call("watch",{name:this.table.name,cell:t,seed:e});n&&(this.app.select("simulator"),document.dispatchEvent(new CustomEvent("open-trial",{detail:n})))}},zp={name:"evaluation",title:"Evaluation",mount(i,t){let e=new Ru(i,t);return{tab:e,greet:n=>e.greet(n)}}};var ix=new Set("H1 H2 H3 H4 H5 H6 P BR HR UL OL LI B STRONG I EM U SUB SUP SMALL BLOCKQUOTE PRE CODE DIV SPAN TABLE CAPTION THEAD TBODY TR TD TH DL DT DD".split(" "));function Hp(i){return Cu(new DOMParser().parseFromString(i,"text/html").body)}function Cu(i){return[...i.childNodes].flatMap(t=>{if(t.nodeType===Node.TEXT_NODE)return[document.createTextNode(t.data)];if(t.nodeName==="IMG"&&/^data:image\//.test(t.getAttribute("src")??"")){let n=document.createElement("img");return n.src=t.getAttribute("src"),n.alt=t.getAttribute("alt")??"",[n]}if(!ix.has(t.nodeName))return t.nodeType===Node.ELEMENT_NODE?Cu(t):[];let e=document.createElement(sx(t.nodeName));return e.append(...Cu(t)),[e]})}var sx=i=>i==="H1"?"H2":i;function Vp(i,t){let e=i.map(o=>[o,rx[o.kind](o,t[o.name])]);return{element:_("div",{class:"questions"},e.map(([,o])=>o.element)),values:()=>Object.fromEntries(e.map(([o,a])=>[o.name,a.value()]).filter(([,o])=>o!==null)),missing:()=>e.filter(([o,a])=>o.required&&a.value()===null).map(([o])=>o.text)}}var Pu=i=>i.required?"":" (optional)";function Gp(i,t,e=[]){return _("fieldset",{},_("legend",{},i.text+Pu(i)),e[0]&&_("span",{class:"end"},e[0]),t.map(([n,s])=>_("label",{class:"option"},n,s)),e[1]&&_("span",{class:"end"},e[1]))}var rx={choice(i,t){let e=[t??[]].flat(),n=i.multiple?"checkbox":"radio",s=i.options.map(({value:o,text:a})=>[_("input",{type:n,name:i.name,value:o,checked:e.includes(o)}),a]),r=()=>{let o=s.filter(([a])=>a.checked).map(([a])=>a.value);return o.length?i.multiple?o:o[0]:null};return{element:Gp(i,s),value:r}},scale(i,t){let e=i.steps.map(r=>[_("input",{type:"radio",name:i.name,value:r,checked:r===t}),String(r)]),n=()=>{let r=e.find(([o])=>o.checked);return r?Number(r[0].value):null},s=Gp(i,e,[i.low,i.high]);return s.classList.add("scale"),{element:s,value:n}},number(i,t){let e=_("input",{type:"number",name:i.name,value:t??"",min:i.min,max:i.max,step:i.step??"any"}),n=i.text+(i.unit?` [${i.unit}]`:"")+Pu(i);return{element:_("label",{class:"field"},_("span",{},n),e),value:()=>e.value===""?null:Number(e.value)}},text(i,t){let e=_("textarea",{name:i.name,rows:4,maxlength:i.most},t??"");return{element:_("label",{class:"field"},_("span",{},i.text+Pu(i)),e),value:()=>e.value.trim()||null}}};var Yo={light:{sky:"#e6ebf1",floor:"#e9ecef",line:"#d3d9de",line10:"#c3cbd2",wall:"#dfe4e9",wallTop:"#6c7884",ground:"#d9c9ad",prop:"#c79f63",door:"#2a7f9e",ink:"#1b2733",shade:.34,sun:2,dome:1.75,start:"#0072b2",goal:"#009e73",source:"#56b4e9",exit:"#d55e00",portal:"#cc79a7",stop:"#e69f00",scan:"#d1431f",cloud:"#8a4fd0",cone:"#e69f00",force:"#c2185b",path:"#5b3fa0",robotGoal:"#d55e00",mark:"#d55e00"},dark:{sky:"#171e26",floor:"#3a444f",line:"#4a5561",line10:"#617080",wall:"#6a7886",wallTop:"#a9b7c4",ground:"#6b5d45",prop:"#a97f45",door:"#4fb3d4",ink:"#e8edf2",shade:.6,sun:2,dome:1.6,start:"#56b4e9",goal:"#2fd0a0",source:"#7cc7f0",exit:"#ff8a3d",portal:"#e79ac4",stop:"#f2b84b",scan:"#ff7a4d",cloud:"#b99cff",cone:"#f2b84b",force:"#ff5c9a",path:"#b7a1ff",robotGoal:"#ff8a3d",mark:"#ff9a52"}};var Hr=[{name:"people",title:"People",visible:!0},{name:"robots",title:"Robots",visible:!0},{name:"walls",title:"Walls",visible:!0},{name:"props",title:"Props and doors",visible:!0},{name:"zones",title:"Zones",visible:!0},{name:"grid",title:"Grid of 1 m",visible:!0},{name:"shadows",title:"Shadows",visible:!0},{name:"ids",title:"Numbers",visible:!1}];function Xp({count:i,who:t,pelvis:e,bones:n,body:s,scale:r,heads:o,parents:a},l,c){let u=new Float64Array(84);for(let d=0;d<i;d++){let h=84*s[t[d]],f=r[t[d]];for(let p=0;p<28;p++){let v=d*c+8*p,m=4*(d*28+p),g=n[m],S=n[m+1],M=n[m+2],y=n[m+3],C=1/Math.hypot(g,S,M,y);g*=C,S*=C,M*=C,y*=C,l[v]=S,l[v+1]=M,l[v+2]=y,l[v+3]=g;let A=a[p];if(A<0)u[0]=e[3*d],u[1]=e[3*d+1],u[2]=e[3*d+2];else{let x=d*c+8*A;Wp(l[x],l[x+1],l[x+2],l[x+3],f*(o[h+3*p]-o[h+3*A]),f*(o[h+3*p+1]-o[h+3*A+1]),f*(o[h+3*p+2]-o[h+3*A+2]));for(let E=0;E<3;E++)u[3*p+E]=u[3*A+E]+Zo[E]}Wp(S,M,y,g,f*o[h+3*p],f*o[h+3*p+1],f*o[h+3*p+2]);for(let x=0;x<3;x++)l[v+4+x]=u[3*p+x]-Zo[x];l[v+7]=0}}}var Zo=new Float64Array(3);function Wp(i,t,e,n,s,r,o){let a=2*(t*o-e*r),l=2*(e*s-i*o),c=2*(i*r-t*s);Zo[0]=s+n*a+t*c-e*l,Zo[1]=r+n*l+e*a-i*c,Zo[2]=o+n*c+i*l-t*a}var ox=65535,Gr=class{constructor(){this.description=null,this.frame=null,this.people=0,this.heads=null,this.parents=null}describe(t,e){this.description=t,this.heads=e.arrays.heads,this.parents=e.arrays.parents,this.frame=null,this.people=0}apply(t){return!this.description||t.arrays.revision[0]!==this.description.revision?!1:(this.frame=t,this.people=t.arrays.who.length,!0)}get walkers(){return this.frame?this.frame.arrays.who.filter(t=>!this.description.people.rider[t]).length:0}get time(){return this.frame?this.frame.time:0}place(t,e){if(!this.frame)return null;let{ids:n,place:s,bots:r,botplace:o}=this.frame.arrays;if(t==="robot"){let l=r.findIndex(c=>this.description.robots[c].id===e);return l<0?null:o.subarray(5*l,5*l+5)}let a=n.indexOf(e);return a<0?null:s.subarray(5*a,5*a+5)}height(t,e){if(t==="robot")return this.description.robots.find(s=>s.id===e)?.height??1;let n=this.frame?this.frame.arrays.ids.indexOf(e):-1;return n<0?1.7:this.description.people.height[this.frame.arrays.who[n]]}pose(t,e){let{who:n,pelvis:s,bones:r}=this.frame.arrays,{body:o,scale:a}=this.description.people;Xp({count:this.people,who:n,pelvis:s,bones:r,body:o,scale:a,heads:this.heads,parents:this.parents},t,e)}scans(t){if(!this.frame)return[];let e=[];return this.description.sensors.forEach((n,s)=>{if(n.kind!==t)return;let r=this.frame.arrays[`scan${s}`],o=this.frame.arrays[`cloud${s}`];r?e.push({number:s,sensor:n,points:ax(r,this.frame.arrays[`pose${s}`],n)}):o&&e.push({number:s,sensor:n,points:o})}),e}};function ax(i,t,e){let n=new Float32Array(3*i.length),[s,r,o,a,l,c,u]=t,d=0;for(let h=0;h<i.length;h++){if(i[h]===ox)continue;let f=e.first+h*e.step,p=i[h]/1e3,v=p*Math.cos(f),m=p*Math.sin(f);n[d++]=s+(1-2*(c*c+u*u))*v+2*(l*c-a*u)*m,n[d++]=r+2*(l*c+a*u)*v+(1-2*(l*l+u*u))*m,n[d++]=o+2*(l*u-a*c)*v+2*(c*u+a*l)*m}return n.subarray(0,d)}function Vr(i,t,e=!0){i.beginPath(),t.forEach(([n,s],r)=>r?i.lineTo(n,s):i.moveTo(n,s)),e&&i.closePath()}function $p(i,t,e,n){let{clientWidth:s,clientHeight:r}=t.canvas,o=[[0,0],[s,0],[s,r],[0,r]].map(([c,u])=>t.place(c,u)),[a,l]=[o.map(c=>c[0]),o.map(c=>c[1])];for(let[c,u]of[[1,e.line],[10,e.line10]])if(!(c/n<9)){i.beginPath();for(let d=c*Math.floor(Math.min(...a)/c);d<=Math.max(...a);d+=c)i.moveTo(d,Math.min(...l)),i.lineTo(d,Math.max(...l));for(let d=c*Math.floor(Math.min(...l)/c);d<=Math.max(...l);d+=c)i.moveTo(Math.min(...a),d),i.lineTo(Math.max(...a),d);i.strokeStyle=u,i.lineWidth=n,i.stroke()}}function qp(i,{zones:t,robots:e},n,s){for(let r of t)Vr(i,r.points),i.fillStyle=i.strokeStyle=n[r.kind],i.globalAlpha=.12,i.fill(),i.globalAlpha=1,i.lineWidth=1.5*s,i.setLineDash(r.kind==="goal"||r.kind==="exit"?[.25,.15]:[]),i.stroke(),i.setLineDash([]);i.strokeStyle=n.robotGoal,i.lineWidth=2*s;for(let{goal:r}of e)i.beginPath(),i.arc(r.x,r.y,r.tolerance,0,2*Math.PI),i.moveTo(r.x,r.y),i.lineTo(r.x,r.y+.9),i.lineTo(r.x+.5,r.y+.7),i.lineTo(r.x,r.y+.5),i.stroke()}function Yp(i,t,e,n,s,r){let{stage:o}=t.description;for(let a of o.ground)lx(i,a,e,n);if(r&&(o.props.forEach((a,l)=>hx(i,a,l,t,e,n)),o.doors.forEach((a,l)=>cx(i,a,t.frame?.arrays.doors?.[l]??0,e,n))),!!s)for(let a of o.walls)Vr(i,a.points,a.solid),i.strokeStyle=e.wallTop,i.fillStyle=e.wall,i.lineWidth=Math.max(2*n,a.solid?0:.06),a.solid&&!a.inner&&i.fill(),i.stroke()}function lx(i,{corners:t,heights:e},n,s){Vr(i,t),i.fillStyle=n.ground,i.globalAlpha=.35+.5*Math.min(1,Math.max(...e)),i.fill(),i.globalAlpha=1,i.strokeStyle=n.wallTop,i.lineWidth=s,i.stroke()}function cx(i,t,e,n,s){let r=t.yaw+(t.kind==="hinged"?e*t.angle:0),o=t.width*(t.kind==="sliding"?1-e:1);i.beginPath(),i.moveTo(t.x,t.y),i.lineTo(t.x+o*Math.cos(r),t.y+o*Math.sin(r)),i.strokeStyle=n.door,i.lineWidth=Math.max(3*s,.06),i.stroke()}function hx(i,t,e,n,s,r){if(t.kind==="none")return;let[o,a,l]=[t.x,t.y,t.heading],c=n.frame?.arrays.propnum?.indexOf(e)??-1;if(c>=0){let[h,f,,p,v,m,g]=n.frame.arrays.props.subarray(7*c,7*c+7);[o,a,l]=[h,f,Math.atan2(2*(p*g+v*m),1-2*(m*m+g*g))]}let[u,d]=t.kind==="table"?[t.length,t.width]:[t.size??2*t.trunk,t.size??2*t.trunk];i.save(),i.translate(o,a),i.rotate(l),i.fillStyle=t.kind==="tree"?"#73543a":s.prop,i.strokeStyle=s.wallTop,i.lineWidth=r,i.beginPath(),t.kind==="tree"?i.arc(0,0,t.trunk,0,2*Math.PI):i.rect(-.5*u,-.5*d,u,d),i.fill(),i.stroke(),t.kind==="tree"&&(i.beginPath(),i.arc(0,0,t.crown,0,2*Math.PI),i.fillStyle="#5f8f4c",i.globalAlpha=.25,i.fill(),i.globalAlpha=1),i.restore()}var Zp=.004;function Jp(i,t,e,n,s,r){let{who:o,ids:a,place:l}=t.frame.arrays,{people:c,regions:u}=t.description,[d,h]=[u.indexOf("top"),u.indexOf("hair")];for(let f=0;f<t.people;f++){let[p,v,m,g,S]=l.subarray(5*f,5*f+5),M=c.rider[o[f]],y=M?.24:c.radius[o[f]],C=c.colors[o[f]];i.beginPath(),i.arc(p,v,y,0,2*Math.PI),i.fillStyle=e.ink,i.globalAlpha=.1,i.fill(),i.globalAlpha=1,i.strokeStyle=e.wallTop,i.lineWidth=n,i.stroke(),i.save(),i.translate(p,v),i.rotate(m),i.fillStyle=`#${C.slice(6*d,6*d+6)}`,i.strokeStyle=e.ink,i.beginPath(),i.ellipse(0,0,.55*y,.95*y,0,0,2*Math.PI),i.fill(),i.stroke(),i.fillStyle=`#${C.slice(6*h,6*h+6)}`,i.beginPath(),i.arc(.08*y,0,.42*y,0,2*Math.PI),i.fill(),i.restore(),Lu(i,p,v,p+.6*g,v+.6*S,e.ink,1.5*n),!M&&(s?.kind==="person"&&s.id===a[f]&&Du(i,p,v,y+.14,e.mark,3*n),r&&Qp(i,String(a[f]),p,v+y+4*n,e.ink,n))}}function jp(i,t,e,n,s){let{bots:r,botplace:o}=t.frame.arrays;r.forEach((a,l)=>{let c=t.description.robots[a],[u,d,h]=o.subarray(5*l,5*l+5);i.save(),i.translate(u,d),i.rotate(h),i.globalAlpha=c.ghost?.4:1,Vr(i,c.footprint),i.fillStyle=e.robotGoal,i.strokeStyle=e.ink,i.lineWidth=1.5*n,i.fill(),i.stroke();let f=.55*c.radius;Vr(i,[[f,0],[-.5*f,.7*f],[-.5*f,-.7*f]]),i.fillStyle=e.floor,i.fill(),i.restore(),Qp(i,c.name,u,d+c.radius+6*n,e.ink,n),s?.kind==="robot"&&s.id===c.id&&Du(i,u,d,c.radius+.14,e.mark,3*n)})}var Iu=[{name:"ranges",under:!0,draw:ux},{name:"goals",under:!0,draw:dx},{name:"scans",under:!1,draw:(...i)=>Kp("scan",3,...i)},{name:"clouds",under:!1,draw:(...i)=>Kp("cloud",1.5,...i)},{name:"forces",under:!1,draw:fx}];function Kp(i,t,e,n,s,r){e.fillStyle=s[i];let o=t*r;for(let{points:a}of n.scans(i))for(let l=0;l<a.length;l+=3)e.fillRect(a[l]-.5*o,a[l+1]-.5*o,o,o)}function ux(i,t,e){let n=t.frame.arrays.cones??[],s=t.description.sensors.filter(r=>r.kind==="cone");i.fillStyle=e.cone,i.globalAlpha=.3;for(let r=0;r<n.length/9;r++){let[o,a,,l,c,u,d,h]=n.subarray(9*r,9*r+9),f=Math.atan2(2*(l*d+c*u),1-2*(u*u+d*d)),p=s[r]?.angle??.2;i.beginPath(),i.moveTo(o,a),i.arc(o,a,h,f-p,f+p),i.closePath(),i.fill()}i.globalAlpha=1}function dx(i,t,e,n){let{goals:s,place:r}=t.frame.arrays;if(s){i.globalAlpha=.5,i.setLineDash([6*n,5*n]);for(let o=0;o<t.people;o++)Number.isFinite(s[2*o])&&Lu(i,r[5*o],r[5*o+1],s[2*o],s[2*o+1],e.goal,1.5*n);i.setLineDash([]),i.globalAlpha=1}}function fx(i,t,e,n){let s=t.frame.arrays.forces??[];for(let r=0;r<s.length/6;r++){let[o,a,,l,c]=s.subarray(6*r,6*r+6);Lu(i,o,a,o+Zp*l,a+Zp*c,e.force,3*n),Du(i,o,a,.05,e.force,2*n)}}function Lu(i,t,e,n,s,r,o){i.beginPath(),i.moveTo(t,e),i.lineTo(n,s),i.strokeStyle=r,i.lineWidth=o,i.stroke()}function Du(i,t,e,n,s,r){i.beginPath(),i.arc(t,e,n,0,2*Math.PI),i.strokeStyle=s,i.lineWidth=r,i.stroke()}function Qp(i,t,e,n,s,r){i.save();let{a:o,b:a,e:l,f:c,c:u,d}=i.getTransform(),h=Math.hypot(o,a)*r;i.setTransform(h,0,0,h,o*e+u*n+l,a*e+d*n+c),i.font="12px system-ui, sans-serif",i.textAlign="center",i.fillStyle=s,i.fillText(t,0,0),i.restore()}var xl=class{constructor(t,e){this.canvas=t,this.x=0,this.y=0,this.scale=30,this.turn=0,this._changed=e,this._listeners=new AbortController;let n=(s,r,o)=>t.addEventListener(s,r,{signal:this._listeners.signal,...o});n("pointerdown",s=>this._press(s)),n("pointermove",s=>this._drag(s)),n("pointerup",()=>this._from=null),n("wheel",s=>this._wheel(s),{passive:!1}),n("keydown",s=>this._key(s))}fit([t,e,n,s]){let{clientWidth:r,clientHeight:o}=this.canvas;this.x=.5*(t+n),this.y=.5*(e+s),this.scale=.96*Math.min((r||800)/(n-t),(o||600)/(s-e)),this.turn=0}point(t,e){let[n,s]=[t-this.x,e-this.y],[r,o]=[Math.cos(this.turn),Math.sin(this.turn)];return[.5*this.canvas.clientWidth+this.scale*(r*n-o*s),.5*this.canvas.clientHeight-this.scale*(o*n+r*s)]}place(t,e){let n=(t-.5*this.canvas.clientWidth)/this.scale,s=-(e-.5*this.canvas.clientHeight)/this.scale,[r,o]=[Math.cos(this.turn),Math.sin(this.turn)];return[this.x+r*n+o*s,this.y-o*n+r*s]}enter(t,e){let n=e*this.scale,[s,r]=[Math.cos(this.turn),Math.sin(this.turn)],[o,a]=this.point(0,0);t.setTransform(n*s,-n*r,-n*r,-n*s,e*o,e*a)}dispose(){this._listeners.abort()}_press(t){this._from=[t.clientX,t.clientY],this.canvas.setPointerCapture(t.pointerId)}_drag(t){if(!this._from)return;let[e,n]=this._from;this._move(t.clientX-e,t.clientY-n),this._from=[t.clientX,t.clientY]}_move(t,e){let n=this.place(0,0),s=this.place(t,e);this.x-=s[0]-n[0],this.y-=s[1]-n[1],this._changed()}_wheel(t){t.preventDefault();let e=this.canvas.getBoundingClientRect();this._zoom(Math.exp(-.0015*t.deltaY),t.clientX-e.left,t.clientY-e.top)}_zoom(t,e,n){let s=this.place(e,n);this.scale=Math.min(400,Math.max(2,this.scale*t));let r=this.place(e,n);this.x+=s[0]-r[0],this.y+=s[1]-r[1],this._changed()}_key(t){if(!t.shiftKey)return;let e={ArrowLeft:[60,0],ArrowRight:[-60,0],ArrowUp:[0,60],ArrowDown:[0,-60]}[t.key],n={"+":1.25,"*":1.25,_:.8}[t.key];!e&&!n||(t.preventDefault(),e?this._move(...e):this._zoom(n,.5*this.canvas.clientWidth,.5*this.canvas.clientHeight))}};var px=70,vl=class{constructor(t,e){this.canvas=t,this.state=new Gr,this._resource=e,this._context=t.getContext("2d"),this._layers=new Map(Hr.filter(n=>n.name!=="shadows").map(n=>[n.name,{...n}])),this._camera="free",this._mark=null,this._frames=0,this._look=Yo.light,this._theme="light",this._view=new xl(t,()=>{this._camera!=="follow"&&(this._camera="free"),this.render()})}async load(t){this._bodies??=await this._fetch("bodies/2.bin");let e=JSON.stringify(this.state.description?.bounds)!==JSON.stringify(t.bounds);this.state.describe(t,this._bodies);for(let{name:n,title:s}of t.layers)this._layers.has(n)||this._layers.set(n,{name:n,title:s,visible:n==="scans"});e&&this._view.fit(t.bounds)}apply(t){return this.state.apply(t)}layers(){return[...this._layers.values()].map(t=>({...t}))}wanted(){let t=new Set(Hr.map(e=>e.name));return this.layers().filter(e=>e.visible&&!t.has(e.name)).map(e=>e.name)}setLayer(t,e){if(!this._layers.has(t))throw new Error(`the scene has no layer ${t}`);this._layers.get(t).visible=e}cameras(){return this.state.description?[{name:"free",title:"Free"},{name:"overview",title:"Overview"},{name:"follow",title:"Follow"},...this.state.description.robots.map(t=>({name:`robot:${t.name}`,title:`From ${t.name}`}))]:[]}get camera(){return this._camera}setCamera(t,e=null){this._camera=t,e&&(this._mark=e),this._view.turn=0,t==="overview"&&this._view.fit(this.state.description.bounds),(t==="follow"||t.startsWith("robot:"))&&(this._view.scale=px)}reset(){this._camera="free",this._view.fit(this.state.description.bounds)}pick(t,e){if(!this.state.frame)return null;let[n,s]=this._view.place(t,e),{ids:r,place:o,bots:a,botplace:l}=this.state.frame.arrays,c=null,u=(d,h,f,p,v)=>{let m=Math.hypot(f-n,p-s)/v;m<=1&&(!c||m<c.away)&&(c={kind:d,id:h,away:m})};return a.forEach((d,h)=>{let f=this.state.description.robots[d];u("robot",f.id,l[5*h],l[5*h+1],f.radius+.05)}),r.forEach((d,h)=>u("person",d,o[5*h],o[5*h+1],.35)),c&&{kind:c.kind,id:c.id}}floor(t,e){let[n,s]=this._view.place(t,e);return{x:n,y:s}}highlight(t,e){this._mark=t==null?null:{kind:t,id:e}}setTheme(t){this._theme=t==="dark"?"dark":"light",this._look=Yo[this._theme]}info(){return{people:this.state.walkers,robots:this.state.frame?this.state.frame.arrays.bots.length:0,levels:[0,0,0],time:this.state.time,sequence:this.state.frame?this.state.frame.sequence:0,calls:0,triangles:0,frames:this._frames,milliseconds:this._spent??0,camera:this._camera,eye:[this._view.x,this._view.y,this._view.scale],theme:this._theme}}render(){let t=performance.now(),e=this._resize(),{_context:n,_look:s,state:r}=this;if(n.setTransform(1,0,0,1,0,0),n.fillStyle=s.floor,n.fillRect(0,0,this.canvas.width,this.canvas.height),r.description){this._lead(),this._view.enter(n,e);let o=l=>this._layers.get(l)?.visible??!1,a=1/this._view.scale;o("grid")&&$p(n,this._view,s,a),o("zones")&&qp(n,r.description,s,a),Yp(n,r,s,a,o("walls"),o("props")),r.frame&&this._figures(o,a)}this._frames+=1,this._spent=performance.now()-t}dispose(){this._view.dispose()}_figures(t,e){let{_context:n,_look:s,state:r}=this;for(let{name:o,under:a,draw:l}of Iu)a&&t(o)&&l(n,r,s,e);t("robots")&&jp(n,r,s,e,this._mark),t("people")&&Jp(n,r,s,e,this._mark,t("ids"));for(let{name:o,under:a,draw:l}of Iu)!a&&t(o)&&l(n,r,s,e)}_lead(){let{state:t}=this;if(!t.frame||this._camera==="free"||this._camera==="overview")return;let e=this._mark;if(this._camera.startsWith("robot:")){let s=t.description.robots.find(r=>`robot:${r.name}`===this._camera);e=s&&{kind:"robot",id:s.id}}else!e&&t.frame.arrays.bots.length&&(e={kind:"robot",id:t.description.robots[t.frame.arrays.bots[0]].id});let n=e&&t.place(e.kind,e.id);n&&([this._view.x,this._view.y]=n,this._view.turn=this._camera==="follow"?0:.5*Math.PI-n[2])}async _fetch(t){let e=await fetch(this._resource(t));if(!e.ok)throw new Error(`${t}: ${(await e.text()).trim()}`);return Ps(await e.arrayBuffer())}_resize(){let t=Math.min(2,devicePixelRatio||1),[e,n]=[Math.round(t*this.canvas.clientWidth),Math.round(t*this.canvas.clientHeight)];return e&&n&&(this.canvas.width!==e||this.canvas.height!==n)&&(this.canvas.width=e,this.canvas.height=n),t}};var Js={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},js={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},Fm=0,pd=1,Om=2;var gr=1,km=2,xo=3,Qs=0,ii=1,$n=2,_r=0,vo=1,md=2,gd=3,_d=4,Bm=5;var yr=100,zm=101,Hm=102,Gm=103,Vm=104,Wm=200,Xm=201,$m=202,qm=203,yd=204,xd=205,Ym=206,Zm=207,Km=208,Jm=209,jm=210,Qm=211,tg=212,eg=213,ng=214,Kl=0,Jl=1,jl=2,so=3,Ql=4,tc=5,ec=6,nc=7,Rc=0,ig=1,sg=2,Qi=0,vd=1,bd=2,Sd=3,Md=4,wd=5,Ed=6,Td=7;var Ad=300,xr=301,bo=302,Cc=303,Pc=304,ic=1e3,Ji=1001,sc=1002,Fn=1003,rg=1004;var La=1005;var ei=1006,Ic=1007;var xs=1008;var ai=1009,Rd=1010,Cd=1011,So=1012,Lc=1013,ki=1014,li=1015,Bi=1016,Dc=1017,Nc=1018,vr=1020,Pd=35902,Id=35899,Ld=1021,Dd=1022,si=1023,gs=1026,vs=1027,Nd=1028,Uc=1029,tr=1030,Fc=1031;var Oc=1033,Da=33776,Na=33777,Ua=33778,Fa=33779,kc=35840,Bc=35841,zc=35842,Hc=35843,Gc=36196,Vc=37492,Wc=37496,Xc=37488,$c=37489,Oa=37490,qc=37491,Yc=37808,Zc=37809,Kc=37810,Jc=37811,jc=37812,Qc=37813,th=37814,eh=37815,nh=37816,ih=37817,sh=37818,rh=37819,oh=37820,ah=37821,lh=36492,ch=36494,hh=36495,uh=36283,dh=36284,ka=36285,fh=36286;var ra=2300,rc=2301,Yl=2302,nd=2303,id=2400,sd=2401,rd=2402;var og=3200;var Ba=0,ag=1,bs="",bn="srgb",oa="srgb-linear",aa="linear",Ae="srgb";var Zl=7680;var lg=519,cg=512,hg=513,ug=514,Ud=515,dg=516,fg=517,Fd=518,Od=519,pg=35044,za=35048;var kd="300 es",Ei=2e3,ro=2001;function mx(i){for(let t=i.length-1;t>=0;--t)if(i[t]>=65535)return!0;return!1}function gx(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function la(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function mg(){let i=la("canvas");return i.style.display="block",i}var tm={},oo=null;function Bd(...i){let t="THREE."+i.shift();oo?oo("log",t,...i):console.log(t,...i)}function gg(i){let t=i[0];if(typeof t=="string"&&t.startsWith("TSL:")){let e=i[1];e&&e.isStackTrace?i[0]+=" "+e.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function Yt(...i){i=gg(i);let t="THREE."+i.shift();if(oo)oo("warn",t,...i);else{let e=i[0];e&&e.isStackTrace?console.warn(e.getError(t)):console.warn(t,...i)}}function te(...i){i=gg(i);let t="THREE."+i.shift();if(oo)oo("error",t,...i);else{let e=i[0];e&&e.isStackTrace?console.error(e.getError(t)):console.error(t,...i)}}function na(...i){let t=i.join(" ");t in tm||(tm[t]=!0,Yt(...i))}function _g(i,t,e){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(t,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:n()}}setTimeout(r,e)})}var yg={[Kl]:Kl,[jl]:ec,[Ql]:Ql,[so]:tc,[Jl]:Jl,[ec]:jl,[nc]:nc,[tc]:so},Ui=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[t]===void 0&&(n[t]=[]),n[t].indexOf(e)===-1&&n[t].push(e)}hasEventListener(t,e){let n=this._listeners;return n===void 0?!1:n[t]!==void 0&&n[t].indexOf(e)!==-1}removeEventListener(t,e){let n=this._listeners;if(n===void 0)return;let s=n[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){let e=this._listeners;if(e===void 0)return;let n=e[t.type];if(n!==void 0){t.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},Vn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],em=1234567,ia=Math.PI/180,ao=180/Math.PI;function Mo(){let i=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(Vn[i&255]+Vn[i>>8&255]+Vn[i>>16&255]+Vn[i>>24&255]+"-"+Vn[t&255]+Vn[t>>8&255]+"-"+Vn[t>>16&15|64]+Vn[t>>24&255]+"-"+Vn[e&63|128]+Vn[e>>8&255]+"-"+Vn[e>>16&255]+Vn[e>>24&255]+Vn[n&255]+Vn[n>>8&255]+Vn[n>>16&255]+Vn[n>>24&255]).toLowerCase()}function pe(i,t,e){return Math.max(t,Math.min(e,i))}function zd(i,t){return(i%t+t)%t}function _x(i,t,e,n,s){return n+(i-t)*(s-n)/(e-t)}function yx(i,t,e){return i!==t?(e-i)/(t-i):0}function sa(i,t,e){return(1-e)*i+e*t}function xx(i,t,e,n){return sa(i,t,1-Math.exp(-e*n))}function vx(i,t=1){return t-Math.abs(zd(i,t*2)-t)}function bx(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*(3-2*i))}function Sx(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*i*(i*(i*6-15)+10))}function Mx(i,t){return i+Math.floor(Math.random()*(t-i+1))}function wx(i,t){return i+Math.random()*(t-i)}function Ex(i){return i*(.5-Math.random())}function Tx(i){i!==void 0&&(em=i);let t=em+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function Ax(i){return i*ia}function Rx(i){return i*ao}function Cx(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function Px(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function Hd(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function Ix(i,t,e,n,s){let r=Math.cos,o=Math.sin,a=r(e/2),l=o(e/2),c=r((t+n)/2),u=o((t+n)/2),d=r((t-n)/2),h=o((t-n)/2),f=r((n-t)/2),p=o((n-t)/2);switch(s){case"XYX":i.set(a*u,l*d,l*h,a*c);break;case"YZY":i.set(l*h,a*u,l*d,a*c);break;case"ZXZ":i.set(l*d,l*h,a*u,a*c);break;case"XZX":i.set(a*u,l*p,l*f,a*c);break;case"YXY":i.set(l*f,a*u,l*p,a*c);break;case"ZYZ":i.set(l*p,l*f,a*u,a*c);break;default:Yt("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function Gd(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function xg(i,t){if(t.constructor===Float32Array)return i;let e=Gd(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/e,-1)}function vg(i,t){if(t.constructor===Float32Array)return i;let e=Gd(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*e)}var wo={DEG2RAD:ia,RAD2DEG:ao,generateUUID:Mo,clamp:pe,euclideanModulo:zd,mapLinear:_x,inverseLerp:yx,lerp:sa,damp:xx,pingpong:vx,smoothstep:bx,smootherstep:Sx,randInt:Mx,randFloat:wx,randFloatSpread:Ex,seededRandom:Tx,degToRad:Ax,radToDeg:Rx,isPowerOfTwo:Cx,ceilPowerOfTwo:Px,floorPowerOfTwo:Hd,setQuaternionFromProperEuler:Ix,normalize:vg,denormalize:xg},Vt=class{static{this.prototype.isVector2=!0}constructor(t=0,e=0){this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("THREE.Vector2: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,n=this.y,s=t.elements;return this.x=s[0]*e+s[3]*n+s[6],this.y=s[1]*e+s[4]*n+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=pe(this.x,t.x,e.x),this.y=pe(this.y,t.y,e.y),this}clampScalar(t,e){return this.x=pe(this.x,t,e),this.y=pe(this.y,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(pe(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(pe(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y;return e*e+n*n}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let n=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*n-o*s+t.x,this.y=r*s+o*n+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},ni=class{constructor(t=0,e=0,n=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=n,this._w=s}static slerpFlat(t,e,n,s,r,o,a){let l=n[s+0],c=n[s+1],u=n[s+2],d=n[s+3],h=r[o+0],f=r[o+1],p=r[o+2],v=r[o+3];if(d!==v||l!==h||c!==f||u!==p){let m=l*h+c*f+u*p+d*v;m<0&&(h=-h,f=-f,p=-p,v=-v,m=-m);let g=1-a;if(m<.9995){let S=Math.acos(m),M=Math.sin(S);g=Math.sin(g*S)/M,a=Math.sin(a*S)/M,l=l*g+h*a,c=c*g+f*a,u=u*g+p*a,d=d*g+v*a}else{l=l*g+h*a,c=c*g+f*a,u=u*g+p*a,d=d*g+v*a;let S=1/Math.sqrt(l*l+c*c+u*u+d*d);l*=S,c*=S,u*=S,d*=S}}t[e]=l,t[e+1]=c,t[e+2]=u,t[e+3]=d}static multiplyQuaternionsFlat(t,e,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],u=n[s+3],d=r[o],h=r[o+1],f=r[o+2],p=r[o+3];return t[e]=a*p+u*d+l*f-c*h,t[e+1]=l*p+u*h+c*d-a*f,t[e+2]=c*p+u*f+a*h-l*d,t[e+3]=u*p-a*d-l*h-c*f,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,n,s){return this._x=t,this._y=e,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let n=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,l=Math.sin,c=a(n/2),u=a(s/2),d=a(r/2),h=l(n/2),f=l(s/2),p=l(r/2);switch(o){case"XYZ":this._x=h*u*d+c*f*p,this._y=c*f*d-h*u*p,this._z=c*u*p+h*f*d,this._w=c*u*d-h*f*p;break;case"YXZ":this._x=h*u*d+c*f*p,this._y=c*f*d-h*u*p,this._z=c*u*p-h*f*d,this._w=c*u*d+h*f*p;break;case"ZXY":this._x=h*u*d-c*f*p,this._y=c*f*d+h*u*p,this._z=c*u*p+h*f*d,this._w=c*u*d-h*f*p;break;case"ZYX":this._x=h*u*d-c*f*p,this._y=c*f*d+h*u*p,this._z=c*u*p-h*f*d,this._w=c*u*d+h*f*p;break;case"YZX":this._x=h*u*d+c*f*p,this._y=c*f*d+h*u*p,this._z=c*u*p-h*f*d,this._w=c*u*d-h*f*p;break;case"XZY":this._x=h*u*d-c*f*p,this._y=c*f*d-h*u*p,this._z=c*u*p+h*f*d,this._w=c*u*d+h*f*p;break;default:Yt("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let n=e/2,s=Math.sin(n);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,n=e[0],s=e[4],r=e[8],o=e[1],a=e[5],l=e[9],c=e[2],u=e[6],d=e[10],h=n+a+d;if(h>0){let f=.5/Math.sqrt(h+1);this._w=.25/f,this._x=(u-l)*f,this._y=(r-c)*f,this._z=(o-s)*f}else if(n>a&&n>d){let f=2*Math.sqrt(1+n-a-d);this._w=(u-l)/f,this._x=.25*f,this._y=(s+o)/f,this._z=(r+c)/f}else if(a>d){let f=2*Math.sqrt(1+a-n-d);this._w=(r-c)/f,this._x=(s+o)/f,this._y=.25*f,this._z=(l+u)/f}else{let f=2*Math.sqrt(1+d-n-a);this._w=(o-s)/f,this._x=(r+c)/f,this._y=(l+u)/f,this._z=.25*f}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let n=t.dot(e)+1;return n<1e-8?(n=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=n):(this._x=0,this._y=-t.z,this._z=t.y,this._w=n)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=n),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(pe(this.dot(t),-1,1)))}rotateTowards(t,e){let n=this.angleTo(t);if(n===0)return this;let s=Math.min(1,e/n);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=e._x,l=e._y,c=e._z,u=e._w;return this._x=n*u+o*a+s*c-r*l,this._y=s*u+o*l+r*a-n*c,this._z=r*u+o*c+n*l-s*a,this._w=o*u-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=this.dot(t);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-e;if(a<.9995){let c=Math.acos(a),u=Math.sin(c);l=Math.sin(l*c)/u,e=Math.sin(e*c)/u,this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this._onChangeCallback()}else this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this.normalize();return this}slerpQuaternions(t,e,n){return this.copy(t).slerp(e,n)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},H=class{static{this.prototype.isVector3=!0}constructor(t=0,e=0,n=0){this.x=t,this.y=e,this.z=n}set(t,e,n){return n===void 0&&(n=this.z),this.x=t,this.y=e,this.z=n,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("THREE.Vector3: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(nm.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(nm.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*n+r[6]*s,this.y=r[1]*e+r[4]*n+r[7]*s,this.z=r[2]*e+r[5]*n+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,n=this.y,s=this.z,r=t.x,o=t.y,a=t.z,l=t.w,c=2*(o*s-a*n),u=2*(a*e-r*s),d=2*(r*n-o*e);return this.x=e+l*c+o*d-a*u,this.y=n+l*u+a*c-r*d,this.z=s+l*d+r*u-o*c,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*n+r[8]*s,this.y=r[1]*e+r[5]*n+r[9]*s,this.z=r[2]*e+r[6]*n+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=pe(this.x,t.x,e.x),this.y=pe(this.y,t.y,e.y),this.z=pe(this.z,t.z,e.z),this}clampScalar(t,e){return this.x=pe(this.x,t,e),this.y=pe(this.y,t,e),this.z=pe(this.z,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(pe(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let n=t.x,s=t.y,r=t.z,o=e.x,a=e.y,l=e.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let n=t.dot(this)/e;return this.copy(t).multiplyScalar(n)}projectOnPlane(t){return Nu.copy(this).projectOnVector(t),this.sub(Nu)}reflect(t){return this.sub(Nu.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(pe(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y,s=this.z-t.z;return e*e+n*n+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,n){let s=Math.sin(e)*t;return this.x=s*Math.sin(n),this.y=Math.cos(e)*t,this.z=s*Math.cos(n),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,n){return this.x=t*Math.sin(e),this.y=n,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),n=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=n,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,n=Math.sqrt(1-e*e);return this.x=n*Math.cos(t),this.y=e,this.z=n*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},Nu=new H,nm=new ni,ne=class{static{this.prototype.isMatrix3=!0}constructor(t,e,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c)}set(t,e,n,s,r,o,a,l,c){let u=this.elements;return u[0]=t,u[1]=s,u[2]=a,u[3]=e,u[4]=r,u[5]=l,u[6]=n,u[7]=o,u[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],this}extractBasis(t,e,n){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],u=n[4],d=n[7],h=n[2],f=n[5],p=n[8],v=s[0],m=s[3],g=s[6],S=s[1],M=s[4],y=s[7],C=s[2],A=s[5],x=s[8];return r[0]=o*v+a*S+l*C,r[3]=o*m+a*M+l*A,r[6]=o*g+a*y+l*x,r[1]=c*v+u*S+d*C,r[4]=c*m+u*M+d*A,r[7]=c*g+u*y+d*x,r[2]=h*v+f*S+p*C,r[5]=h*m+f*M+p*A,r[8]=h*g+f*y+p*x,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],u=t[8];return e*o*u-e*a*c-n*r*u+n*a*l+s*r*c-s*o*l}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],u=t[8],d=u*o-a*c,h=a*l-u*r,f=c*r-o*l,p=e*d+n*h+s*f;if(p===0)return this.set(0,0,0,0,0,0,0,0,0);let v=1/p;return t[0]=d*v,t[1]=(s*c-u*n)*v,t[2]=(a*n-s*o)*v,t[3]=h*v,t[4]=(u*e-s*l)*v,t[5]=(s*r-a*e)*v,t[6]=f*v,t[7]=(n*l-c*e)*v,t[8]=(o*e-n*r)*v,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+t,-s*c,s*l,-s*(-c*o+l*a)+a+e,0,0,1),this}scale(t,e){return na("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Uu.makeScale(t,e)),this}rotate(t){return na("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Uu.makeRotation(-t)),this}translate(t,e){return na("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Uu.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,n,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<9;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<9;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t}clone(){return new this.constructor().fromArray(this.elements)}},Uu=new ne,im=new ne().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),sm=new ne().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function Lx(){let i={enabled:!0,workingColorSpace:oa,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Ae&&(s.r=ms(s.r),s.g=ms(s.g),s.b=ms(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Ae&&(s.r=io(s.r),s.g=io(s.g),s.b=io(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===bs?aa:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],e=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[oa]:{primaries:t,whitePoint:n,transfer:aa,toXYZ:im,fromXYZ:sm,luminanceCoefficients:e,workingColorSpaceConfig:{unpackColorSpace:bn},outputColorSpaceConfig:{drawingBufferColorSpace:bn}},[bn]:{primaries:t,whitePoint:n,transfer:Ae,toXYZ:im,fromXYZ:sm,luminanceCoefficients:e,outputColorSpaceConfig:{drawingBufferColorSpace:bn}}}),i}var _e=Lx();function ms(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function io(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var Wr,oc=class{static getDataURL(t,e="image/png"){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let n;if(t instanceof HTMLCanvasElement)n=t;else{Wr===void 0&&(Wr=la("canvas")),Wr.width=t.width,Wr.height=t.height;let s=Wr.getContext("2d");t instanceof ImageData?s.putImageData(t,0,0):s.drawImage(t,0,0,t.width,t.height),n=Wr}return n.toDataURL(e)}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=la("canvas");e.width=t.width,e.height=t.height;let n=e.getContext("2d");n.drawImage(t,0,0,t.width,t.height);let s=n.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=ms(r[o]/255)*255;return n.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let n=0;n<e.length;n++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[n]=Math.floor(ms(e[n]/255)*255):e[n]=ms(e[n]);return{data:e,width:t.width,height:t.height}}else return Yt("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},Dx=0,lo=class{constructor(t=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:Dx++}),this.uuid=Mo(),this.data=t,this.dataReady=!0,this.version=0}getSize(t){let e=this.data;return typeof HTMLVideoElement<"u"&&e instanceof HTMLVideoElement?t.set(e.videoWidth,e.videoHeight,0):typeof VideoFrame<"u"&&e instanceof VideoFrame?t.set(e.displayWidth,e.displayHeight,0):e!==null?t.set(e.width||0,e.height||0,e.depth||0):t.set(0,0,0),t}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(Fu(s[o].image)):r.push(Fu(s[o]))}else r=Fu(s);n.url=r}return e||(t.images[this.uuid]=n),n}};function Fu(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?oc.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(Yt("Texture: Unable to serialize Texture."),{})}var Nx=0,Ou=new H,oi=class i extends Ui{constructor(t=i.DEFAULT_IMAGE,e=i.DEFAULT_MAPPING,n=Ji,s=Ji,r=ei,o=xs,a=si,l=ai,c=i.DEFAULT_ANISOTROPY,u=bs){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:Nx++}),this.uuid=Mo(),this.name="",this.source=new lo(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new Vt(0,0),this.repeat=new Vt(1,1),this.center=new Vt(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new ne,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=u,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Ou).x}get height(){return this.source.getSize(Ou).y}get depth(){return this.source.getSize(Ou).z}get image(){return this.source.data}set image(t){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.normalized=t.normalized,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.mipmapsAutoUpdate=t.mipmapsAutoUpdate,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.renderTarget=t.renderTarget,this.isRenderTargetTexture=t.isRenderTargetTexture,this.isPMREMTexture=t.isPMREMTexture,this.isArrayTexture=t.isArrayTexture,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}setValues(t){for(let e in t){let n=t[e];if(n===void 0){Yt(`Texture.setValues(): parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Yt(`Texture.setValues(): property '${e}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),e||(t.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==Ad)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case ic:t.x=t.x-Math.floor(t.x);break;case Ji:t.x=t.x<0?0:1;break;case sc:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case ic:t.y=t.y-Math.floor(t.y);break;case Ji:t.y=t.y<0?0:1;break;case sc:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};oi.DEFAULT_IMAGE=null;oi.DEFAULT_MAPPING=Ad;oi.DEFAULT_ANISOTROPY=1;var je=class{static{this.prototype.isVector4=!0}constructor(t=0,e=0,n=0,s=1){this.x=t,this.y=e,this.z=n,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,n,s){return this.x=t,this.y=e,this.z=n,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("THREE.Vector4: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*n+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,n,s,r,l=t.elements,c=l[0],u=l[4],d=l[8],h=l[1],f=l[5],p=l[9],v=l[2],m=l[6],g=l[10];if(Math.abs(u-h)<.01&&Math.abs(d-v)<.01&&Math.abs(p-m)<.01){if(Math.abs(u+h)<.1&&Math.abs(d+v)<.1&&Math.abs(p+m)<.1&&Math.abs(c+f+g-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let M=(c+1)/2,y=(f+1)/2,C=(g+1)/2,A=(u+h)/4,x=(d+v)/4,E=(p+m)/4;return M>y&&M>C?M<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(M),s=A/n,r=x/n):y>C?y<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(y),n=A/s,r=E/s):C<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(C),n=x/r,s=E/r),this.set(n,s,r,e),this}let S=Math.sqrt((m-p)*(m-p)+(d-v)*(d-v)+(h-u)*(h-u));return Math.abs(S)<.001&&(S=1),this.x=(m-p)/S,this.y=(d-v)/S,this.z=(h-u)/S,this.w=Math.acos((c+f+g-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=pe(this.x,t.x,e.x),this.y=pe(this.y,t.y,e.y),this.z=pe(this.z,t.z,e.z),this.w=pe(this.w,t.w,e.w),this}clampScalar(t,e){return this.x=pe(this.x,t,e),this.y=pe(this.y,t,e),this.z=pe(this.z,t,e),this.w=pe(this.w,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(pe(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this.w=t.w+(e.w-t.w)*n,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},ac=class extends Ui{constructor(t=1,e=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:ei,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=n.depth,this.scissor=new je(0,0,t,e),this.scissorTest=!1,this.viewport=new je(0,0,t,e),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new oi({width:t,height:e,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(t={}){let e={minFilter:ei,generateMipmaps:!1,flipY:!1,internalFormat:null};t.mapping!==void 0&&(e.mapping=t.mapping),t.wrapS!==void 0&&(e.wrapS=t.wrapS),t.wrapT!==void 0&&(e.wrapT=t.wrapT),t.wrapR!==void 0&&(e.wrapR=t.wrapR),t.magFilter!==void 0&&(e.magFilter=t.magFilter),t.minFilter!==void 0&&(e.minFilter=t.minFilter),t.format!==void 0&&(e.format=t.format),t.type!==void 0&&(e.type=t.type),t.anisotropy!==void 0&&(e.anisotropy=t.anisotropy),t.colorSpace!==void 0&&(e.colorSpace=t.colorSpace),t.flipY!==void 0&&(e.flipY=t.flipY),t.generateMipmaps!==void 0&&(e.generateMipmaps=t.generateMipmaps),t.mipmapsAutoUpdate!==void 0&&(e.mipmapsAutoUpdate=t.mipmapsAutoUpdate),t.internalFormat!==void 0&&(e.internalFormat=t.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(e)}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}set depthTexture(t){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),t!==null&&t.renderTarget===null&&(t.renderTarget=this),this._depthTexture=t}get depthTexture(){return this._depthTexture}setSize(t,e,n=1){if(this.width!==t||this.height!==e||this.depth!==n){this.width=t,this.height=e,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let e=0,n=t.textures.length;e<n;e++){this.textures[e]=t.textures[e].clone(),this.textures[e].isRenderTargetTexture=!0,this.textures[e].renderTarget=this;let s=Object.assign({},t.textures[e].image);this.textures[e].source=new lo(s)}if(this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveColorBuffer=t.resolveColorBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,this.storeMultisampledColorBuffer=t.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=t.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=t.storeMultisampledStencilBuffer,t.depthTexture!==null)if(t.depthTexture.renderTarget===t){let e=t.depthTexture.clone();e.renderTarget=null,this.depthTexture=e}else this.depthTexture=t.depthTexture;else this.depthTexture=null;return this.samples=t.samples,this.multiview=t.multiview,this.useArrayDepthTexture=t.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},gi=class extends ac{constructor(t=1,e=1,n={}){super(t,e,n),this.isWebGLRenderTarget=!0}},ca=class extends oi{constructor(t=null,e=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Fn,this.minFilter=Fn,this.wrapR=Ji,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var lc=class extends oi{constructor(t=null,e=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Fn,this.minFilter=Fn,this.wrapR=Ji,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}};var Oe=class i{static{this.prototype.isMatrix4=!0}constructor(t,e,n,s,r,o,a,l,c,u,d,h,f,p,v,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c,u,d,h,f,p,v,m)}set(t,e,n,s,r,o,a,l,c,u,d,h,f,p,v,m){let g=this.elements;return g[0]=t,g[4]=e,g[8]=n,g[12]=s,g[1]=r,g[5]=o,g[9]=a,g[13]=l,g[2]=c,g[6]=u,g[10]=d,g[14]=h,g[3]=f,g[7]=p,g[11]=v,g[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],e[9]=n[9],e[10]=n[10],e[11]=n[11],e[12]=n[12],e[13]=n[13],e[14]=n[14],e[15]=n[15],this}copyPosition(t){let e=this.elements,n=t.elements;return e[12]=n[12],e[13]=n[13],e[14]=n[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,n){return this.determinantAffine()===0?(t.set(1,0,0),e.set(0,1,0),n.set(0,0,1),this):(t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(t,e,n){return this.set(t.x,e.x,n.x,0,t.y,e.y,n.y,0,t.z,e.z,n.z,0,0,0,0,1),this}extractRotation(t){if(t.determinantAffine()===0)return this.identity();let e=this.elements,n=t.elements,s=1/Xr.setFromMatrixColumn(t,0).length(),r=1/Xr.setFromMatrixColumn(t,1).length(),o=1/Xr.setFromMatrixColumn(t,2).length();return e[0]=n[0]*s,e[1]=n[1]*s,e[2]=n[2]*s,e[3]=0,e[4]=n[4]*r,e[5]=n[5]*r,e[6]=n[6]*r,e[7]=0,e[8]=n[8]*o,e[9]=n[9]*o,e[10]=n[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,n=t.x,s=t.y,r=t.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),u=Math.cos(r),d=Math.sin(r);if(t.order==="XYZ"){let h=o*u,f=o*d,p=a*u,v=a*d;e[0]=l*u,e[4]=-l*d,e[8]=c,e[1]=f+p*c,e[5]=h-v*c,e[9]=-a*l,e[2]=v-h*c,e[6]=p+f*c,e[10]=o*l}else if(t.order==="YXZ"){let h=l*u,f=l*d,p=c*u,v=c*d;e[0]=h+v*a,e[4]=p*a-f,e[8]=o*c,e[1]=o*d,e[5]=o*u,e[9]=-a,e[2]=f*a-p,e[6]=v+h*a,e[10]=o*l}else if(t.order==="ZXY"){let h=l*u,f=l*d,p=c*u,v=c*d;e[0]=h-v*a,e[4]=-o*d,e[8]=p+f*a,e[1]=f+p*a,e[5]=o*u,e[9]=v-h*a,e[2]=-o*c,e[6]=a,e[10]=o*l}else if(t.order==="ZYX"){let h=o*u,f=o*d,p=a*u,v=a*d;e[0]=l*u,e[4]=p*c-f,e[8]=h*c+v,e[1]=l*d,e[5]=v*c+h,e[9]=f*c-p,e[2]=-c,e[6]=a*l,e[10]=o*l}else if(t.order==="YZX"){let h=o*l,f=o*c,p=a*l,v=a*c;e[0]=l*u,e[4]=v-h*d,e[8]=p*d+f,e[1]=d,e[5]=o*u,e[9]=-a*u,e[2]=-c*u,e[6]=f*d+p,e[10]=h-v*d}else if(t.order==="XZY"){let h=o*l,f=o*c,p=a*l,v=a*c;e[0]=l*u,e[4]=-d,e[8]=c*u,e[1]=h*d+v,e[5]=o*u,e[9]=f*d-p,e[2]=p*d-f,e[6]=a*u,e[10]=v*d+h}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(Ux,t,Fx)}lookAt(t,e,n){let s=this.elements;return pi.subVectors(t,e),pi.lengthSq()===0&&(pi.z=1),pi.normalize(),Ds.crossVectors(n,pi),Ds.lengthSq()===0&&(Math.abs(n.z)===1?pi.x+=1e-4:pi.z+=1e-4,pi.normalize(),Ds.crossVectors(n,pi)),Ds.normalize(),bl.crossVectors(pi,Ds),s[0]=Ds.x,s[4]=bl.x,s[8]=pi.x,s[1]=Ds.y,s[5]=bl.y,s[9]=pi.y,s[2]=Ds.z,s[6]=bl.z,s[10]=pi.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],u=n[1],d=n[5],h=n[9],f=n[13],p=n[2],v=n[6],m=n[10],g=n[14],S=n[3],M=n[7],y=n[11],C=n[15],A=s[0],x=s[4],E=s[8],F=s[12],L=s[1],D=s[5],B=s[9],G=s[13],N=s[2],W=s[6],q=s[10],V=s[14],lt=s[3],Z=s[7],j=s[11],et=s[15];return r[0]=o*A+a*L+l*N+c*lt,r[4]=o*x+a*D+l*W+c*Z,r[8]=o*E+a*B+l*q+c*j,r[12]=o*F+a*G+l*V+c*et,r[1]=u*A+d*L+h*N+f*lt,r[5]=u*x+d*D+h*W+f*Z,r[9]=u*E+d*B+h*q+f*j,r[13]=u*F+d*G+h*V+f*et,r[2]=p*A+v*L+m*N+g*lt,r[6]=p*x+v*D+m*W+g*Z,r[10]=p*E+v*B+m*q+g*j,r[14]=p*F+v*G+m*V+g*et,r[3]=S*A+M*L+y*N+C*lt,r[7]=S*x+M*D+y*W+C*Z,r[11]=S*E+M*B+y*q+C*j,r[15]=S*F+M*G+y*V+C*et,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[12],o=t[1],a=t[5],l=t[9],c=t[13],u=t[2],d=t[6],h=t[10],f=t[14],p=t[3],v=t[7],m=t[11],g=t[15],S=l*f-c*h,M=a*f-c*d,y=a*h-l*d,C=o*f-c*u,A=o*h-l*u,x=o*d-a*u;return e*(v*S-m*M+g*y)-n*(p*S-m*C+g*A)+s*(p*M-v*C+g*x)-r*(p*y-v*A+m*x)}determinantAffine(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[1],o=t[5],a=t[9],l=t[2],c=t[6],u=t[10];return e*(o*u-a*c)-n*(r*u-a*l)+s*(r*c-o*l)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,n){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=n),this}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],u=t[8],d=t[9],h=t[10],f=t[11],p=t[12],v=t[13],m=t[14],g=t[15],S=e*a-n*o,M=e*l-s*o,y=e*c-r*o,C=n*l-s*a,A=n*c-r*a,x=s*c-r*l,E=u*v-d*p,F=u*m-h*p,L=u*g-f*p,D=d*m-h*v,B=d*g-f*v,G=h*g-f*m,N=S*G-M*B+y*D+C*L-A*F+x*E;if(N===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let W=1/N;return t[0]=(a*G-l*B+c*D)*W,t[1]=(s*B-n*G-r*D)*W,t[2]=(v*x-m*A+g*C)*W,t[3]=(h*A-d*x-f*C)*W,t[4]=(l*L-o*G-c*F)*W,t[5]=(e*G-s*L+r*F)*W,t[6]=(m*y-p*x-g*M)*W,t[7]=(u*x-h*y+f*M)*W,t[8]=(o*B-a*L+c*E)*W,t[9]=(n*L-e*B-r*E)*W,t[10]=(p*A-v*y+g*S)*W,t[11]=(d*y-u*A-f*S)*W,t[12]=(a*F-o*D-l*E)*W,t[13]=(e*D-n*F+s*E)*W,t[14]=(v*M-p*C-m*S)*W,t[15]=(u*C-d*M+h*S)*W,this}scale(t){let e=this.elements,n=t.x,s=t.y,r=t.z;return e[0]*=n,e[4]*=s,e[8]*=r,e[1]*=n,e[5]*=s,e[9]*=r,e[2]*=n,e[6]*=s,e[10]*=r,e[3]*=n,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],n=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,n,s))}makeTranslation(t,e,n){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,n,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),n=Math.sin(t);return this.set(1,0,0,0,0,e,-n,0,0,n,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,0,n,0,0,1,0,0,-n,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,0,n,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let n=Math.cos(e),s=Math.sin(e),r=1-n,o=t.x,a=t.y,l=t.z,c=r*o,u=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,u*a+n,u*l-s*o,0,c*l-s*a,u*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(t,e,n){return this.set(t,0,0,0,0,e,0,0,0,0,n,0,0,0,0,1),this}makeShear(t,e,n,s,r,o){return this.set(1,n,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,n){let s=this.elements,r=e._x,o=e._y,a=e._z,l=e._w,c=r+r,u=o+o,d=a+a,h=r*c,f=r*u,p=r*d,v=o*u,m=o*d,g=a*d,S=l*c,M=l*u,y=l*d,C=n.x,A=n.y,x=n.z;return s[0]=(1-(v+g))*C,s[1]=(f+y)*C,s[2]=(p-M)*C,s[3]=0,s[4]=(f-y)*A,s[5]=(1-(h+g))*A,s[6]=(m+S)*A,s[7]=0,s[8]=(p+M)*x,s[9]=(m-S)*x,s[10]=(1-(h+v))*x,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,n){let s=this.elements;t.x=s[12],t.y=s[13],t.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),e.identity(),this;let o=Xr.set(s[0],s[1],s[2]).length(),a=Xr.set(s[4],s[5],s[6]).length(),l=Xr.set(s[8],s[9],s[10]).length();r<0&&(o=-o),Li.copy(this);let c=1/o,u=1/a,d=1/l;return Li.elements[0]*=c,Li.elements[1]*=c,Li.elements[2]*=c,Li.elements[4]*=u,Li.elements[5]*=u,Li.elements[6]*=u,Li.elements[8]*=d,Li.elements[9]*=d,Li.elements[10]*=d,e.setFromRotationMatrix(Li),n.x=o,n.y=a,n.z=l,this}makePerspective(t,e,n,s,r,o,a=Ei,l=!1){let c=this.elements,u=2*r/(e-t),d=2*r/(n-s),h=(e+t)/(e-t),f=(n+s)/(n-s),p,v;if(l)p=r/(o-r),v=o*r/(o-r);else if(a===Ei)p=-(o+r)/(o-r),v=-2*o*r/(o-r);else if(a===ro)p=-o/(o-r),v=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=u,c[4]=0,c[8]=h,c[12]=0,c[1]=0,c[5]=d,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=p,c[14]=v,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(t,e,n,s,r,o,a=Ei,l=!1){let c=this.elements,u=2/(e-t),d=2/(n-s),h=-(e+t)/(e-t),f=-(n+s)/(n-s),p,v;if(l)p=1/(o-r),v=o/(o-r);else if(a===Ei)p=-2/(o-r),v=-(o+r)/(o-r);else if(a===ro)p=-1/(o-r),v=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=u,c[4]=0,c[8]=0,c[12]=h,c[1]=0,c[5]=d,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=p,c[14]=v,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<16;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<16;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t[e+9]=n[9],t[e+10]=n[10],t[e+11]=n[11],t[e+12]=n[12],t[e+13]=n[13],t[e+14]=n[14],t[e+15]=n[15],t}},Xr=new H,Li=new Oe,Ux=new H(0,0,0),Fx=new H(1,1,1),Ds=new H,bl=new H,pi=new H,rm=new Oe,om=new ni,ji=class i{constructor(t=0,e=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=n,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,n,s=this._order){return this._x=t,this._y=e,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,n=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],u=s[9],d=s[2],h=s[6],f=s[10];switch(e){case"XYZ":this._y=Math.asin(pe(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-u,f),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(h,c),this._z=0);break;case"YXZ":this._x=Math.asin(-pe(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(a,f),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-d,r),this._z=0);break;case"ZXY":this._x=Math.asin(pe(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(-d,f),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-pe(d,-1,1)),Math.abs(d)<.9999999?(this._x=Math.atan2(h,f),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(pe(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-u,c),this._y=Math.atan2(-d,r)):(this._x=0,this._y=Math.atan2(a,f));break;case"XZY":this._z=Math.asin(-pe(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(h,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-u,f),this._y=0);break;default:Yt("Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,n===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,n){return rm.makeRotationFromQuaternion(t),this.setFromRotationMatrix(rm,e,n)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return om.setFromEuler(this),this.setFromQuaternion(om,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};ji.DEFAULT_ORDER="XYZ";var co=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},Ox=0,am=new H,$r=new ni,hs=new Oe,Sl=new H,Ko=new H,kx=new H,Bx=new ni,lm=new H(1,0,0),cm=new H(0,1,0),hm=new H(0,0,1),um={type:"added"},zx={type:"removed"},qr={type:"childadded",child:null},ku={type:"childremoved",child:null},Sn=class i extends Ui{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Ox++}),this.uuid=Mo(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let t=new H,e=new ji,n=new ni,s=new H(1,1,1);function r(){n.setFromEuler(e,!1)}function o(){e.setFromQuaternion(n,void 0,!1)}e._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Oe},normalMatrix:{value:new ne}}),this.matrix=new Oe,this.matrixWorld=new Oe,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new co,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return $r.setFromAxisAngle(t,e),this.quaternion.multiply($r),this}rotateOnWorldAxis(t,e){return $r.setFromAxisAngle(t,e),this.quaternion.premultiply($r),this}rotateX(t){return this.rotateOnAxis(lm,t)}rotateY(t){return this.rotateOnAxis(cm,t)}rotateZ(t){return this.rotateOnAxis(hm,t)}translateOnAxis(t,e){return am.copy(t).applyQuaternion(this.quaternion),this.position.add(am.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(lm,t)}translateY(t){return this.translateOnAxis(cm,t)}translateZ(t){return this.translateOnAxis(hm,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(hs.copy(this.matrixWorld).invert())}lookAt(t,e,n){t.isVector3?Sl.copy(t):Sl.set(t,e,n);let s=this.parent;this.updateWorldMatrix(!0,!1),Ko.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?hs.lookAt(Ko,Sl,this.up):hs.lookAt(Sl,Ko,this.up),this.quaternion.setFromRotationMatrix(hs),s&&(hs.extractRotation(s.matrixWorld),$r.setFromRotationMatrix(hs),this.quaternion.premultiply($r.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(te("Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(um),qr.child=t,this.dispatchEvent(qr),qr.child=null):te("Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(zx),ku.child=t,this.dispatchEvent(ku),ku.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),hs.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),hs.multiply(t.parent.matrixWorld)),t.applyMatrix4(hs),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(um),qr.child=t,this.dispatchEvent(qr),qr.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,n=[]){this[t]===e&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,n);return n}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ko,t,kx),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ko,Bx,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(t){t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let t=this.pivot;if(t!==null){let e=t.x,n=t.y,s=t.z,r=this.matrix.elements;r[12]+=e-r[0]*e-r[4]*n-r[8]*s,r[13]+=n-r[1]*e-r[5]*n-r[9]*s,r[14]+=s-r[2]*e-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].updateMatrixWorld(t)}updateWorldMatrix(t,e,n=!1){let s=this.parent;if(t===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),e===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(t){let e=t===void 0||typeof t=="string",n={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(t),s.indirectTexture=this._indirectTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(t)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,u=l.length;c<u;c++){let d=l[c];r(t.shapes,d)}else r(t.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(t.materials,this.material[l]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(t.animations,l))}}if(e){let a=o(t.geometries),l=o(t.materials),c=o(t.textures),u=o(t.images),d=o(t.shapes),h=o(t.skeletons),f=o(t.animations),p=o(t.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),u.length>0&&(n.images=u),d.length>0&&(n.shapes=d),h.length>0&&(n.skeletons=h),f.length>0&&(n.animations=f),p.length>0&&(n.nodes=p)}return n.object=s,n;function o(a){let l=[];for(let c in a){let u=a[c];delete u.metadata,l.push(u)}return l}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.pivot=t.pivot!==null?t.pivot.clone():null,this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.static=t.static,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let n=0;n<t.children.length;n++){let s=t.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Sn.DEFAULT_UP=new H(0,1,0);Sn.DEFAULT_MATRIX_AUTO_UPDATE=!0;Sn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var ln=class extends Sn{constructor(){super(),this.isGroup=!0,this.type="Group"}},Hx={type:"move"},ho=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new ln,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new ln,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new H,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new H),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new ln,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new H,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new H,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let n of t.hand.values())this._getHandJoint(e,n)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(c&&t.hand){o=!0;for(let v of t.hand.values()){let m=e.getJointPose(v,n),g=this._getHandJoint(c,v);m!==null&&(g.matrix.fromArray(m.transform.matrix),g.matrix.decompose(g.position,g.quaternion,g.scale),g.matrixWorldNeedsUpdate=!0,g.jointRadius=m.radius),g.visible=m!==null}let u=c.joints["index-finger-tip"],d=c.joints["thumb-tip"],h=u.position.distanceTo(d.position),f=.02,p=.005;c.inputState.pinching&&h>f+p?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!c.inputState.pinching&&h<=f-p&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else l!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:t,target:this})));a!==null&&(s=e.getPose(t.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(Hx)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let n=new ln;n.matrixAutoUpdate=!1,n.visible=!1,t.joints[e.jointName]=n,t.add(n)}return t.joints[e.jointName]}},bg={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Ns={h:0,s:0,l:0},Ml={h:0,s:0,l:0};function Bu(i,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?i+(t-i)*6*e:e<1/2?t:e<2/3?i+(t-i)*6*(2/3-e):i}var Zt=class{constructor(t,e,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,n)}set(t,e,n){if(e===void 0&&n===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,n);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=bn){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,_e.colorSpaceToWorking(this,e),this}setRGB(t,e,n,s=_e.workingColorSpace){return this.r=t,this.g=e,this.b=n,_e.colorSpaceToWorking(this,s),this}setHSL(t,e,n,s=_e.workingColorSpace){if(t=zd(t,1),e=pe(e,0,1),n=pe(n,0,1),e===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+e):n+e-n*e,o=2*n-r;this.r=Bu(o,r,t+1/3),this.g=Bu(o,r,t),this.b=Bu(o,r,t-1/3)}return _e.colorSpaceToWorking(this,s),this}setStyle(t,e=bn){function n(r){r!==void 0&&parseFloat(r)<1&&Yt("Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,e);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:Yt("Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);Yt("Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=bn){let n=bg[t.toLowerCase()];return n!==void 0?this.setHex(n,e):Yt("Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=ms(t.r),this.g=ms(t.g),this.b=ms(t.b),this}copyLinearToSRGB(t){return this.r=io(t.r),this.g=io(t.g),this.b=io(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=bn){return _e.workingToColorSpace(Wn.copy(this),t),Math.round(pe(Wn.r*255,0,255))*65536+Math.round(pe(Wn.g*255,0,255))*256+Math.round(pe(Wn.b*255,0,255))}getHexString(t=bn){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=_e.workingColorSpace){_e.workingToColorSpace(Wn.copy(this),e);let n=Wn.r,s=Wn.g,r=Wn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,u=(a+o)/2;if(a===o)l=0,c=0;else{let d=o-a;switch(c=u<=.5?d/(o+a):d/(2-o-a),o){case n:l=(s-r)/d+(s<r?6:0);break;case s:l=(r-n)/d+2;break;case r:l=(n-s)/d+4;break}l/=6}return t.h=l,t.s=c,t.l=u,t}getRGB(t,e=_e.workingColorSpace){return _e.workingToColorSpace(Wn.copy(this),e),t.r=Wn.r,t.g=Wn.g,t.b=Wn.b,t}getStyle(t=bn){_e.workingToColorSpace(Wn.copy(this),t);let e=Wn.r,n=Wn.g,s=Wn.b;return t!==bn?`color(${t} ${e.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(t,e,n){return this.getHSL(Ns),this.setHSL(Ns.h+t,Ns.s+e,Ns.l+n)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,n){return this.r=t.r+(e.r-t.r)*n,this.g=t.g+(e.g-t.g)*n,this.b=t.b+(e.b-t.b)*n,this}lerpHSL(t,e){this.getHSL(Ns),t.getHSL(Ml);let n=sa(Ns.h,Ml.h,e),s=sa(Ns.s,Ml.s,e),r=sa(Ns.l,Ml.l,e);return this.setHSL(n,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,n=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*n+r[6]*s,this.g=r[1]*e+r[4]*n+r[7]*s,this.b=r[2]*e+r[5]*n+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},Wn=new Zt;Zt.NAMES=bg;var ha=class i{constructor(t,e=1,n=1e3){this.isFog=!0,this.name="",this.color=new Zt(t),this.near=e,this.far=n}clone(){return new i(this.color,this.near,this.far)}toJSON(){return{type:"Fog",name:this.name,color:this.color.getHex(),near:this.near,far:this.far}}},ua=class extends Sn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new ji,this.environmentIntensity=1,this.environmentRotation=new ji,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),this.background=t.background!==null?t.background.clone():null,this.environment=t.environment!==null?t.environment.clone():null,this.fog=t.fog!==null?t.fog.clone():null,this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),this.overrideMaterial=t.overrideMaterial!==null?t.overrideMaterial.clone():null,this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),e.object.backgroundBlurriness=this.backgroundBlurriness,e.object.backgroundIntensity=this.backgroundIntensity,e.object.backgroundRotation=this.backgroundRotation.toArray(),e.object.environmentIntensity=this.environmentIntensity,e.object.environmentRotation=this.environmentRotation.toArray(),e}},Di=new H,us=new H,zu=new H,ds=new H,Yr=new H,Zr=new H,dm=new H,Hu=new H,Gu=new H,Vu=new H,Wu=new je,Xu=new je,$u=new je,ks=class i{constructor(t=new H,e=new H,n=new H){this.a=t,this.b=e,this.c=n}static getNormal(t,e,n,s){s.subVectors(n,e),Di.subVectors(t,e),s.cross(Di);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,n,s,r){Di.subVectors(s,e),us.subVectors(n,e),zu.subVectors(t,e);let o=Di.dot(Di),a=Di.dot(us),l=Di.dot(zu),c=us.dot(us),u=us.dot(zu),d=o*c-a*a;if(d===0)return r.set(0,0,0),null;let h=1/d,f=(c*l-a*u)*h,p=(o*u-a*l)*h;return r.set(1-f-p,p,f)}static containsPoint(t,e,n,s){return this.getBarycoord(t,e,n,s,ds)===null?!1:ds.x>=0&&ds.y>=0&&ds.x+ds.y<=1}static getInterpolation(t,e,n,s,r,o,a,l){return this.getBarycoord(t,e,n,s,ds)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,ds.x),l.addScaledVector(o,ds.y),l.addScaledVector(a,ds.z),l)}static getInterpolatedAttribute(t,e,n,s,r,o){return Wu.setScalar(0),Xu.setScalar(0),$u.setScalar(0),Wu.fromBufferAttribute(t,e),Xu.fromBufferAttribute(t,n),$u.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(Wu,r.x),o.addScaledVector(Xu,r.y),o.addScaledVector($u,r.z),o}static isFrontFacing(t,e,n,s){return Di.subVectors(n,e),us.subVectors(t,e),Di.cross(us).dot(s)<0}set(t,e,n){return this.a.copy(t),this.b.copy(e),this.c.copy(n),this}setFromPointsAndIndices(t,e,n,s){return this.a.copy(t[e]),this.b.copy(t[n]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,n,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,n),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return Di.subVectors(this.c,this.b),us.subVectors(this.a,this.b),Di.cross(us).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return i.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return i.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,n,s,r){return i.getInterpolation(t,this.a,this.b,this.c,e,n,s,r)}containsPoint(t){return i.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return i.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let n=this.a,s=this.b,r=this.c,o,a;Yr.subVectors(s,n),Zr.subVectors(r,n),Hu.subVectors(t,n);let l=Yr.dot(Hu),c=Zr.dot(Hu);if(l<=0&&c<=0)return e.copy(n);Gu.subVectors(t,s);let u=Yr.dot(Gu),d=Zr.dot(Gu);if(u>=0&&d<=u)return e.copy(s);let h=l*d-u*c;if(h<=0&&l>=0&&u<=0&&l-u>0)return o=l/(l-u),e.copy(n).addScaledVector(Yr,o);Vu.subVectors(t,r);let f=Yr.dot(Vu),p=Zr.dot(Vu);if(p>=0&&f<=p)return e.copy(r);let v=f*c-l*p;if(v<=0&&c>=0&&p<=0)return a=c/(c-p),e.copy(n).addScaledVector(Zr,a);let m=u*p-f*d;if(m<=0&&d-u>=0&&f-p>=0)return dm.subVectors(r,s),a=(d-u)/(d-u+(f-p)),e.copy(s).addScaledVector(dm,a);let g=1/(m+v+h);return o=v*g,a=h*g,e.copy(n).addScaledVector(Yr,o).addScaledVector(Zr,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},Bs=class{constructor(t=new H(1/0,1/0,1/0),e=new H(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e+=3)this.expandByPoint(Ni.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,n=t.count;e<n;e++)this.expandByPoint(Ni.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let n=Ni.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(n),this.max.copy(t).add(n),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let n=t.geometry;if(n!==void 0){let r=n.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0&&t.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,Ni):Ni.fromBufferAttribute(r,o),Ni.applyMatrix4(t.matrixWorld),this.expandByPoint(Ni);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),wl.copy(t.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),wl.copy(n.boundingBox)),wl.applyMatrix4(t.matrixWorld),this.union(wl)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,Ni),Ni.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,n;return t.normal.x>0?(e=t.normal.x*this.min.x,n=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,n=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,n+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,n+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,n+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,n+=t.normal.z*this.min.z),e<=-t.constant&&n>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(Jo),El.subVectors(this.max,Jo),Kr.subVectors(t.a,Jo),Jr.subVectors(t.b,Jo),jr.subVectors(t.c,Jo),Us.subVectors(Jr,Kr),Fs.subVectors(jr,Jr),ar.subVectors(Kr,jr);let e=[0,-Us.z,Us.y,0,-Fs.z,Fs.y,0,-ar.z,ar.y,Us.z,0,-Us.x,Fs.z,0,-Fs.x,ar.z,0,-ar.x,-Us.y,Us.x,0,-Fs.y,Fs.x,0,-ar.y,ar.x,0];return!qu(e,Kr,Jr,jr,El)||(e=[1,0,0,0,1,0,0,0,1],!qu(e,Kr,Jr,jr,El))?!1:(Tl.crossVectors(Us,Fs),e=[Tl.x,Tl.y,Tl.z],qu(e,Kr,Jr,jr,El))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,Ni).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(Ni).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(fs[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),fs[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),fs[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),fs[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),fs[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),fs[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),fs[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),fs[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(fs),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(t){return this.min.fromArray(t.min),this.max.fromArray(t.max),this}},fs=[new H,new H,new H,new H,new H,new H,new H,new H],Ni=new H,wl=new Bs,Kr=new H,Jr=new H,jr=new H,Us=new H,Fs=new H,ar=new H,Jo=new H,El=new H,Tl=new H,lr=new H;function qu(i,t,e,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){lr.fromArray(i,r);let a=s.x*Math.abs(lr.x)+s.y*Math.abs(lr.y)+s.z*Math.abs(lr.z),l=t.dot(lr),c=e.dot(lr),u=n.dot(lr);if(Math.max(-Math.max(l,c,u),Math.min(l,c,u))>a)return!1}return!0}var _n=new H,Al=new Vt,Gx=0,Ge=class extends Ui{constructor(t,e,n=!1){if(super(),Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:Gx++}),this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=n,this.usage=pg,this.updateRanges=[],this.gpuType=li,this.version=0,this._normalizationScale=t!==void 0?Gd(t):void 0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this._normalizationScale=t._normalizationScale,this}copyAt(t,e,n){t*=this.itemSize,n*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[n+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,n=this.count;e<n;e++)Al.fromBufferAttribute(this,e),Al.applyMatrix3(t),this.setXY(e,Al.x,Al.y);else if(this.itemSize===3)for(let e=0,n=this.count;e<n;e++)_n.fromBufferAttribute(this,e),_n.applyMatrix3(t),this.setXYZ(e,_n.x,_n.y,_n.z);return this}applyMatrix4(t){for(let e=0,n=this.count;e<n;e++)_n.fromBufferAttribute(this,e),_n.applyMatrix4(t),this.setXYZ(e,_n.x,_n.y,_n.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)_n.fromBufferAttribute(this,e),_n.applyNormalMatrix(t),this.setXYZ(e,_n.x,_n.y,_n.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)_n.fromBufferAttribute(this,e),_n.transformDirection(t),this.setXYZ(e,_n.x,_n.y,_n.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let n=this.array[t*this.itemSize+e];return this.normalized&&(n=this._denormalize(n)),n}setComponent(t,e,n){return this.normalized&&(n=this._normalize(n)),this.array[t*this.itemSize+e]=n,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=this._denormalize(e)),e}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=this._denormalize(e)),e}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=this._denormalize(e)),e}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=this._denormalize(e)),e}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,n){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n)),this.array[t+0]=e,this.array[t+1]=n,this}setXYZ(t,e,n,s){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return t.name=this.name,t.usage=this.usage,t.gpuType=this.gpuType,t}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):xg(t,this.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):vg(t,this.array)}};var da=class extends Ge{constructor(t,e,n){super(new Uint16Array(t),e,n)}};var fa=class extends Ge{constructor(t,e,n){super(new Uint32Array(t),e,n)}};var Re=class extends Ge{constructor(t,e,n){super(new Float32Array(t),e,n)}},Vx=new Bs,jo=new H,Yu=new H,zs=class{constructor(t=new H,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let n=this.center;e!==void 0?n.copy(e):Vx.setFromPoints(t).getCenter(n);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,n.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let n=this.center.distanceToSquared(t);return e.copy(t),n>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;jo.subVectors(t,this.center);let e=jo.lengthSq();if(e>this.radius*this.radius){let n=Math.sqrt(e),s=(n-this.radius)*.5;this.center.addScaledVector(jo,s/n),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(Yu.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(jo.copy(t.center).add(Yu)),this.expandByPoint(jo.copy(t.center).sub(Yu))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(t){return this.radius=t.radius,this.center.fromArray(t.center),this}},Wx=0,wi=new Oe,Zu=new Sn,Qr=new H,mi=new Bs,Qo=new Bs,Un=new H,Ve=class i extends Ui{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:Wx++}),this.uuid=Mo(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(mx(t)?fa:da)(t,1):this.index=t,this}setIndirect(t,e=0){return this.indirect=t,this.indirectOffset=e,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,n=0){this.groups.push({start:t,count:e,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new ne().getNormalMatrix(t);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(t){return wi.makeRotationFromQuaternion(t),this.applyMatrix4(wi),this}rotateX(t){return wi.makeRotationX(t),this.applyMatrix4(wi),this}rotateY(t){return wi.makeRotationY(t),this.applyMatrix4(wi),this}rotateZ(t){return wi.makeRotationZ(t),this.applyMatrix4(wi),this}translate(t,e,n){return wi.makeTranslation(t,e,n),this.applyMatrix4(wi),this}scale(t,e,n){return wi.makeScale(t,e,n),this.applyMatrix4(wi),this}lookAt(t){return Zu.lookAt(t),Zu.updateMatrix(),this.applyMatrix4(Zu.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(Qr).negate(),this.translate(Qr.x,Qr.y,Qr.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let n=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Re(n,3))}else{let n=Math.min(t.length,e.count);for(let s=0;s<n;s++){let r=t[s];e.setXYZ(s,r.x,r.y,r.z||0)}t.length>e.count&&Yt("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Bs);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){te("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new H(-1/0,-1/0,-1/0),new H(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let n=0,s=e.length;n<s;n++){let r=e[n];mi.setFromBufferAttribute(r),this.morphTargetsRelative?(Un.addVectors(this.boundingBox.min,mi.min),this.boundingBox.expandByPoint(Un),Un.addVectors(this.boundingBox.max,mi.max),this.boundingBox.expandByPoint(Un)):(this.boundingBox.expandByPoint(mi.min),this.boundingBox.expandByPoint(mi.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&te('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new zs);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){te("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new H,1/0);return}if(t){let n=this.boundingSphere.center;if(mi.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];Qo.setFromBufferAttribute(a),this.morphTargetsRelative?(Un.addVectors(mi.min,Qo.min),mi.expandByPoint(Un),Un.addVectors(mi.max,Qo.max),mi.expandByPoint(Un)):(mi.expandByPoint(Qo.min),mi.expandByPoint(Qo.max))}mi.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)Un.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared(Un));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],l=this.morphTargetsRelative;for(let c=0,u=a.count;c<u;c++)Un.fromBufferAttribute(a,c),l&&(Qr.fromBufferAttribute(t,c),Un.add(Qr)),s=Math.max(s,n.distanceToSquared(Un))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&te('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){te("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=e.position,s=e.normal,r=e.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ge(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let F=0;F<n.count;F++)a[F]=new H,l[F]=new H;let u=new H,d=new H,h=new H,f=new Vt,p=new Vt,v=new Vt,m=new H,g=new H;function S(F,L,D){c[F]=c[L]=c[D]=1,u.fromBufferAttribute(n,F),d.fromBufferAttribute(n,L),h.fromBufferAttribute(n,D),f.fromBufferAttribute(r,F),p.fromBufferAttribute(r,L),v.fromBufferAttribute(r,D),d.sub(u),h.sub(u),p.sub(f),v.sub(f);let B=1/(p.x*v.y-v.x*p.y);isFinite(B)&&(m.copy(d).multiplyScalar(v.y).addScaledVector(h,-p.y).multiplyScalar(B),g.copy(h).multiplyScalar(p.x).addScaledVector(d,-v.x).multiplyScalar(B),a[F].add(m),a[L].add(m),a[D].add(m),l[F].add(g),l[L].add(g),l[D].add(g))}let M=this.groups;M.length===0&&(M=[{start:0,count:t.count}]);for(let F=0,L=M.length;F<L;++F){let D=M[F],B=D.start,G=D.count;for(let N=B,W=B+G;N<W;N+=3)S(t.getX(N+0),t.getX(N+1),t.getX(N+2))}let y=new H,C=new H,A=new H,x=new H;function E(F){A.fromBufferAttribute(s,F),x.copy(A);let L=a[F];y.copy(L),y.sub(A.multiplyScalar(A.dot(L))).normalize(),C.crossVectors(x,L);let B=C.dot(l[F])<0?-1:1;o.setXYZW(F,y.x,y.y,y.z,B)}for(let F=0,L=n.count;F<L;++F)c[F]&&E(F);this._transformed=!0}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==e.count)n=new Ge(new Float32Array(e.count*3),3),this.setAttribute("normal",n);else for(let h=0,f=n.count;h<f;h++)n.setXYZ(h,0,0,0);let s=new H,r=new H,o=new H,a=new H,l=new H,c=new H,u=new H,d=new H;if(t)for(let h=0,f=t.count;h<f;h+=3){let p=t.getX(h+0),v=t.getX(h+1),m=t.getX(h+2);s.fromBufferAttribute(e,p),r.fromBufferAttribute(e,v),o.fromBufferAttribute(e,m),u.subVectors(o,r),d.subVectors(s,r),u.cross(d),a.fromBufferAttribute(n,p),l.fromBufferAttribute(n,v),c.fromBufferAttribute(n,m),a.add(u),l.add(u),c.add(u),n.setXYZ(p,a.x,a.y,a.z),n.setXYZ(v,l.x,l.y,l.z),n.setXYZ(m,c.x,c.y,c.z)}else for(let h=0,f=e.count;h<f;h+=3)s.fromBufferAttribute(e,h+0),r.fromBufferAttribute(e,h+1),o.fromBufferAttribute(e,h+2),u.subVectors(o,r),d.subVectors(s,r),u.cross(d),n.setXYZ(h+0,u.x,u.y,u.z),n.setXYZ(h+1,u.x,u.y,u.z),n.setXYZ(h+2,u.x,u.y,u.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,n=t.count;e<n;e++)Un.fromBufferAttribute(t,e),Un.normalize(),t.setXYZ(e,Un.x,Un.y,Un.z)}toNonIndexed(){function t(a,l){let c=a.array,u=a.itemSize,d=a.normalized,h=new c.constructor(l.length*u),f=0,p=0;for(let v=0,m=l.length;v<m;v++){a.isInterleavedBufferAttribute?f=l[v]*a.data.stride+a.offset:f=l[v]*u;for(let g=0;g<u;g++)h[p++]=c[f++]}return new Ge(h,u,d)}if(this.index===null)return Yt("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=t(l,n);e.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let u=0,d=c.length;u<d;u++){let h=c[u],f=t(h,n);l.push(f)}e.morphAttributes[a]=l}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];e.addGroup(c.start,c.count,c.materialIndex)}return e}toJSON(){let t={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,t.name=this.name,Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(t[c]=l[c]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let n=this.attributes;for(let l in n){let c=n[l];t.data.attributes[l]=c.toJSON(t.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],u=[];for(let d=0,h=c.length;d<h;d++){let f=c[d];u.push(f.toJSON(t.data))}u.length>0&&(s[l]=u,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere=a.toJSON()),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let n=t.index;n!==null&&this.setIndex(n.clone());let s=t.attributes;for(let c in s){let u=s[c];this.setAttribute(c,u.clone(e))}let r=t.morphAttributes;for(let c in r){let u=[],d=r[c];for(let h=0,f=d.length;h<f;h++)u.push(d[h].clone(e));this.morphAttributes[c]=u}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let c=0,u=o.length;c<u;c++){let d=o[c];this.addGroup(d.start,d.count,d.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=t.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this._transformed=t._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var Ku=new H,Xx=new H,$x=new ne,zn=class{constructor(t=new H(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,n,s){return this.normal.set(t,e,n),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,n){let s=Ku.subVectors(n,e).cross(Xx.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e,n=!0){let s=t.delta(Ku),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let o=-(t.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:e.copy(t.start).addScaledVector(s,o)}intersectsLine(t){let e=this.distanceToPoint(t.start),n=this.distanceToPoint(t.end);return e<0&&n>0||n<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let n=e||$x.getNormalMatrix(t),s=this.coplanarPoint(Ku).applyMatrix4(t),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(t){return this.normal.fromArray(t.normal),this.constant=t.constant,this}},qx=0,Fi=class extends Ui{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:qx++}),this.uuid=Mo(),this.name="",this.type="Material",this.blending=vo,this.side=Qs,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=yd,this.blendDst=xd,this.blendEquation=yr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Zt(0,0,0),this.blendAlpha=0,this.depthFunc=so,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=lg,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Zl,this.stencilZFail=Zl,this.stencilZPass=Zl,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let n=t[e];if(n===void 0){Yt(`Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Yt(`Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(t).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(t).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(t).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(t).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(t).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(t).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(t).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(t).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(t,e){if(t.uuid!==void 0&&(this.uuid=t.uuid),t.name!==void 0&&(this.name=t.name),t.color!==void 0&&this.color!==void 0&&this.color.setHex(t.color),t.roughness!==void 0&&(this.roughness=t.roughness),t.metalness!==void 0&&(this.metalness=t.metalness),t.sheen!==void 0&&(this.sheen=t.sheen),t.sheenColor!==void 0&&(this.sheenColor=new Zt().setHex(t.sheenColor)),t.sheenRoughness!==void 0&&(this.sheenRoughness=t.sheenRoughness),t.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(t.emissive),t.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(t.specular),t.specularIntensity!==void 0&&(this.specularIntensity=t.specularIntensity),t.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(t.specularColor),t.shininess!==void 0&&(this.shininess=t.shininess),t.clearcoat!==void 0&&(this.clearcoat=t.clearcoat),t.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=t.clearcoatRoughness),t.diffuseRoughness!==void 0&&(this.diffuseRoughness=t.diffuseRoughness),t.dispersion!==void 0&&(this.dispersion=t.dispersion),t.retroreflectivity!==void 0&&(this.retroreflectivity=t.retroreflectivity),t.iridescence!==void 0&&(this.iridescence=t.iridescence),t.iridescenceIOR!==void 0&&(this.iridescenceIOR=t.iridescenceIOR),t.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessMinimum),t.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=t.iridescenceThicknessMaximum),t.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=t.iridescenceThicknessRange[1]),t.transmission!==void 0&&(this.transmission=t.transmission),t.thickness!==void 0&&(this.thickness=t.thickness),t.attenuationDistance!==void 0&&(this.attenuationDistance=t.attenuationDistance),t.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(t.attenuationColor),t.anisotropy!==void 0&&(this.anisotropy=t.anisotropy),t.anisotropyRotation!==void 0&&(this.anisotropyRotation=t.anisotropyRotation),t.fog!==void 0&&(this.fog=t.fog),t.flatShading!==void 0&&(this.flatShading=t.flatShading),t.blending!==void 0&&(this.blending=t.blending),t.combine!==void 0&&(this.combine=t.combine),t.side!==void 0&&(this.side=t.side),t.shadowSide!==void 0&&(this.shadowSide=t.shadowSide),t.opacity!==void 0&&(this.opacity=t.opacity),t.transparent!==void 0&&(this.transparent=t.transparent),t.alphaTest!==void 0&&(this.alphaTest=t.alphaTest),t.alphaHash!==void 0&&(this.alphaHash=t.alphaHash),t.depthFunc!==void 0&&(this.depthFunc=t.depthFunc),t.depthTest!==void 0&&(this.depthTest=t.depthTest),t.depthWrite!==void 0&&(this.depthWrite=t.depthWrite),t.colorWrite!==void 0&&(this.colorWrite=t.colorWrite),t.clippingPlanes!==void 0&&(this.clippingPlanes=t.clippingPlanes.map(n=>new zn().fromJSON(n))),t.clipIntersection!==void 0&&(this.clipIntersection=t.clipIntersection),t.clipShadows!==void 0&&(this.clipShadows=t.clipShadows),t.depthPacking!==void 0&&(this.depthPacking=t.depthPacking),t.blendSrc!==void 0&&(this.blendSrc=t.blendSrc),t.blendDst!==void 0&&(this.blendDst=t.blendDst),t.blendEquation!==void 0&&(this.blendEquation=t.blendEquation),t.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=t.blendSrcAlpha),t.blendDstAlpha!==void 0&&(this.blendDstAlpha=t.blendDstAlpha),t.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=t.blendEquationAlpha),t.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(t.blendColor),t.blendAlpha!==void 0&&(this.blendAlpha=t.blendAlpha),t.stencilWriteMask!==void 0&&(this.stencilWriteMask=t.stencilWriteMask),t.stencilFunc!==void 0&&(this.stencilFunc=t.stencilFunc),t.stencilRef!==void 0&&(this.stencilRef=t.stencilRef),t.stencilFuncMask!==void 0&&(this.stencilFuncMask=t.stencilFuncMask),t.stencilFail!==void 0&&(this.stencilFail=t.stencilFail),t.stencilZFail!==void 0&&(this.stencilZFail=t.stencilZFail),t.stencilZPass!==void 0&&(this.stencilZPass=t.stencilZPass),t.stencilWrite!==void 0&&(this.stencilWrite=t.stencilWrite),t.wireframe!==void 0&&(this.wireframe=t.wireframe),t.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=t.wireframeLinewidth),t.wireframeLinecap!==void 0&&(this.wireframeLinecap=t.wireframeLinecap),t.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=t.wireframeLinejoin),t.rotation!==void 0&&(this.rotation=t.rotation),t.linewidth!==void 0&&(this.linewidth=t.linewidth),t.linecap!==void 0&&(this.linecap=t.linecap),t.linejoin!==void 0&&(this.linejoin=t.linejoin),t.dashSize!==void 0&&(this.dashSize=t.dashSize),t.gapSize!==void 0&&(this.gapSize=t.gapSize),t.scale!==void 0&&(this.scale=t.scale),t.polygonOffset!==void 0&&(this.polygonOffset=t.polygonOffset),t.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=t.polygonOffsetFactor),t.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=t.polygonOffsetUnits),t.dithering!==void 0&&(this.dithering=t.dithering),t.alphaToCoverage!==void 0&&(this.alphaToCoverage=t.alphaToCoverage),t.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=t.premultipliedAlpha),t.forceSinglePass!==void 0&&(this.forceSinglePass=t.forceSinglePass),t.allowOverride!==void 0&&(this.allowOverride=t.allowOverride),t.visible!==void 0&&(this.visible=t.visible),t.toneMapped!==void 0&&(this.toneMapped=t.toneMapped),t.userData!==void 0&&(this.userData=t.userData),t.vertexColors!==void 0&&(typeof t.vertexColors=="number"?this.vertexColors=t.vertexColors>0:this.vertexColors=t.vertexColors),t.size!==void 0&&(this.size=t.size),t.sizeAttenuation!==void 0&&(this.sizeAttenuation=t.sizeAttenuation),t.map!==void 0&&(this.map=e[t.map]||null),t.matcap!==void 0&&(this.matcap=e[t.matcap]||null),t.alphaMap!==void 0&&(this.alphaMap=e[t.alphaMap]||null),t.bumpMap!==void 0&&(this.bumpMap=e[t.bumpMap]||null),t.bumpScale!==void 0&&(this.bumpScale=t.bumpScale),t.normalMap!==void 0&&(this.normalMap=e[t.normalMap]||null),t.normalMapType!==void 0&&(this.normalMapType=t.normalMapType),t.normalScale!==void 0){let n=t.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new Vt().fromArray(n)}return t.displacementMap!==void 0&&(this.displacementMap=e[t.displacementMap]||null),t.displacementScale!==void 0&&(this.displacementScale=t.displacementScale),t.displacementBias!==void 0&&(this.displacementBias=t.displacementBias),t.roughnessMap!==void 0&&(this.roughnessMap=e[t.roughnessMap]||null),t.metalnessMap!==void 0&&(this.metalnessMap=e[t.metalnessMap]||null),t.emissiveMap!==void 0&&(this.emissiveMap=e[t.emissiveMap]||null),t.emissiveIntensity!==void 0&&(this.emissiveIntensity=t.emissiveIntensity),t.specularMap!==void 0&&(this.specularMap=e[t.specularMap]||null),t.specularIntensityMap!==void 0&&(this.specularIntensityMap=e[t.specularIntensityMap]||null),t.specularColorMap!==void 0&&(this.specularColorMap=e[t.specularColorMap]||null),t.envMap!==void 0&&(this.envMap=e[t.envMap]||null),t.envMapRotation!==void 0&&this.envMapRotation.fromArray(t.envMapRotation),t.envMapIntensity!==void 0&&(this.envMapIntensity=t.envMapIntensity),t.reflectivity!==void 0&&(this.reflectivity=t.reflectivity),t.refractionRatio!==void 0&&(this.refractionRatio=t.refractionRatio),t.lightMap!==void 0&&(this.lightMap=e[t.lightMap]||null),t.lightMapIntensity!==void 0&&(this.lightMapIntensity=t.lightMapIntensity),t.aoMap!==void 0&&(this.aoMap=e[t.aoMap]||null),t.aoMapIntensity!==void 0&&(this.aoMapIntensity=t.aoMapIntensity),t.gradientMap!==void 0&&(this.gradientMap=e[t.gradientMap]||null),t.clearcoatMap!==void 0&&(this.clearcoatMap=e[t.clearcoatMap]||null),t.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=e[t.clearcoatRoughnessMap]||null),t.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=e[t.clearcoatNormalMap]||null),t.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new Vt().fromArray(t.clearcoatNormalScale)),t.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=e[t.diffuseRoughnessMap]||null),t.iridescenceMap!==void 0&&(this.iridescenceMap=e[t.iridescenceMap]||null),t.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=e[t.iridescenceThicknessMap]||null),t.transmissionMap!==void 0&&(this.transmissionMap=e[t.transmissionMap]||null),t.thicknessMap!==void 0&&(this.thicknessMap=e[t.thicknessMap]||null),t.anisotropyMap!==void 0&&(this.anisotropyMap=e[t.anisotropyMap]||null),t.sheenColorMap!==void 0&&(this.sheenColorMap=e[t.sheenColorMap]||null),t.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=e[t.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,n=null;if(e!==null){let s=e.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=e[r].clone()}return this.clippingPlanes=n,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.allowOverride=t.allowOverride,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}};var ps=new H,Ju=new H,Rl=new H,Cl=new H,_s=class{constructor(t=new H,e=new H(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,ps)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let n=e.dot(this.direction);return n<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=ps.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(ps.copy(this.origin).addScaledVector(this.direction,e),ps.distanceToSquared(t))}distanceSqToSegment(t,e,n,s){Ju.copy(t).add(e).multiplyScalar(.5),Rl.copy(e).sub(t).normalize(),Cl.copy(this.origin).sub(Ju);let r=t.distanceTo(e)*.5,o=-this.direction.dot(Rl),a=Cl.dot(this.direction),l=-Cl.dot(Rl),c=Cl.lengthSq(),u=Math.abs(1-o*o),d,h,f,p;if(u>0)if(d=o*l-a,h=o*a-l,p=r*u,d>=0)if(h>=-p)if(h<=p){let v=1/u;d*=v,h*=v,f=d*(d+o*h+2*a)+h*(o*d+h+2*l)+c}else h=r,d=Math.max(0,-(o*h+a)),f=-d*d+h*(h+2*l)+c;else h=-r,d=Math.max(0,-(o*h+a)),f=-d*d+h*(h+2*l)+c;else h<=-p?(d=Math.max(0,-(-o*r+a)),h=d>0?-r:Math.min(Math.max(-r,-l),r),f=-d*d+h*(h+2*l)+c):h<=p?(d=0,h=Math.min(Math.max(-r,-l),r),f=h*(h+2*l)+c):(d=Math.max(0,-(o*r+a)),h=d>0?r:Math.min(Math.max(-r,-l),r),f=-d*d+h*(h+2*l)+c);else h=o>0?-r:r,d=Math.max(0,-(o*h+a)),f=-d*d+h*(h+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,d),s&&s.copy(Ju).addScaledVector(Rl,h),f}intersectSphere(t,e){if(t.radius<0)return null;ps.subVectors(t.center,this.origin);let n=ps.dot(this.direction),s=ps.dot(ps)-n*n,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,e):this.at(a,e)}intersectsSphere(t){return t.radius<0?!1:this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(t.normal)+t.constant)/e;return n>=0?n:null}intersectPlane(t,e){let n=this.distanceToPlane(t);return n===null?null:this.at(n,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let n,s,r,o,a,l,c=1/this.direction.x,u=1/this.direction.y,d=1/this.direction.z,h=this.origin;return c>=0?(n=(t.min.x-h.x)*c,s=(t.max.x-h.x)*c):(n=(t.max.x-h.x)*c,s=(t.min.x-h.x)*c),u>=0?(r=(t.min.y-h.y)*u,o=(t.max.y-h.y)*u):(r=(t.max.y-h.y)*u,o=(t.min.y-h.y)*u),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),d>=0?(a=(t.min.z-h.z)*d,l=(t.max.z-h.z)*d):(a=(t.max.z-h.z)*d,l=(t.min.z-h.z)*d),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,e)}intersectsBox(t){return this.intersectBox(t,ps)!==null}intersectTriangle(t,e,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,u=a.z,d=t.x-o.x,h=t.y-o.y,f=t.z-o.z,p=e.x-o.x,v=e.y-o.y,m=e.z-o.z,g=n.x-o.x,S=n.y-o.y,M=n.z-o.z,y=Math.abs(l),C=Math.abs(c),A=Math.abs(u),x,E,F,L,D,B,G,N,W,q,V,lt;if(y>=C&&y>=A?(F=l,B=d,W=p,lt=g,l>=0?(x=c,E=u,L=h,D=f,G=v,N=m,q=S,V=M):(x=u,E=c,L=f,D=h,G=m,N=v,q=M,V=S)):C>=A?(F=c,B=h,W=v,lt=S,c>=0?(x=u,E=l,L=f,D=d,G=m,N=p,q=M,V=g):(x=l,E=u,L=d,D=f,G=p,N=m,q=g,V=M)):(F=u,B=f,W=m,lt=M,u>=0?(x=l,E=c,L=d,D=h,G=p,N=v,q=g,V=S):(x=c,E=l,L=h,D=d,G=v,N=p,q=S,V=g)),F===0)return null;let Z=x/F,j=E/F,et=1/F,dt=L-Z*B,ut=D-j*B,tt=G-Z*W,mt=N-j*W,yt=q-Z*lt,At=V-j*lt,St=yt*mt-At*tt,Xt=dt*At-ut*yt,re=tt*ut-mt*dt;if(s){if(St<0||Xt<0||re<0)return null}else if((St<0||Xt<0||re<0)&&(St>0||Xt>0||re>0))return null;let Gt=St+Xt+re;if(Gt===0)return null;let ue=et*(St*B+Xt*W+re*lt);return(Gt>0?ue<0:ue>0)?null:this.at(ue/Gt,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},_i=class extends Fi{constructor(t){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Zt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ji,this.combine=Rc,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}},fm=new Oe,cr=new _s,Pl=new zs,pm=new H,Il=new H,Ll=new H,Dl=new H,ju=new H,Nl=new H,mm=new H,Ul=new H,ke=class extends Sn{constructor(t=new Ve,e=new _i){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){Nl.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let u=a[l],d=r[l];u!==0&&(ju.fromBufferAttribute(d,t),o?Nl.addScaledVector(ju,u):Nl.addScaledVector(ju.sub(e),u))}e.add(Nl)}return e}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),Pl.copy(n.boundingSphere),Pl.applyMatrix4(r),cr.copy(t.ray).recast(t.near),!(Pl.containsPoint(cr.origin)===!1&&(cr.intersectSphere(Pl,pm)===null||cr.origin.distanceToSquared(pm)>(t.far-t.near)**2))&&(fm.copy(r).invert(),cr.copy(t.ray).applyMatrix4(fm),!(n.boundingBox!==null&&cr.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(t,e,cr)))}_computeIntersections(t,e,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,u=r.attributes.uv1,d=r.attributes.normal,h=r.groups,f=r.drawRange;if(a!==null)if(Array.isArray(o))for(let p=0,v=h.length;p<v;p++){let m=h[p],g=o[m.materialIndex],S=Math.max(m.start,f.start),M=Math.min(a.count,Math.min(m.start+m.count,f.start+f.count));for(let y=S,C=M;y<C;y+=3){let A=a.getX(y),x=a.getX(y+1),E=a.getX(y+2);s=Fl(this,g,t,n,c,u,d,A,x,E),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,f.start),v=Math.min(a.count,f.start+f.count);for(let m=p,g=v;m<g;m+=3){let S=a.getX(m),M=a.getX(m+1),y=a.getX(m+2);s=Fl(this,o,t,n,c,u,d,S,M,y),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let p=0,v=h.length;p<v;p++){let m=h[p],g=o[m.materialIndex],S=Math.max(m.start,f.start),M=Math.min(l.count,Math.min(m.start+m.count,f.start+f.count));for(let y=S,C=M;y<C;y+=3){let A=y,x=y+1,E=y+2;s=Fl(this,g,t,n,c,u,d,A,x,E),s&&(s.faceIndex=Math.floor(y/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,f.start),v=Math.min(l.count,f.start+f.count);for(let m=p,g=v;m<g;m+=3){let S=m,M=m+1,y=m+2;s=Fl(this,o,t,n,c,u,d,S,M,y),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}}};function Yx(i,t,e,n,s,r,o,a){let l;if(t.side===ii?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,t.side===Qs,a),l===null)return null;Ul.copy(a),Ul.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(Ul);return c<e.near||c>e.far?null:{distance:c,point:Ul.clone(),object:i}}function Fl(i,t,e,n,s,r,o,a,l,c){i.getVertexPosition(a,Il),i.getVertexPosition(l,Ll),i.getVertexPosition(c,Dl);let u=Yx(i,t,e,n,Il,Ll,Dl,mm);if(u){let d=new H;ks.getBarycoord(mm,Il,Ll,Dl,d),s&&(u.uv=ks.getInterpolatedAttribute(s,a,l,c,d,new Vt)),r&&(u.uv1=ks.getInterpolatedAttribute(r,a,l,c,d,new Vt)),o&&(u.normal=ks.getInterpolatedAttribute(o,a,l,c,d,new H),u.normal.dot(n.direction)>0&&u.normal.multiplyScalar(-1));let h={a,b:l,c,normal:new H,materialIndex:0};ks.getNormal(Il,Ll,Dl,h.normal),u.face=h,u.barycoord=d}return u}var Hs=class extends oi{constructor(t=null,e=1,n=1,s,r,o,a,l,c=Fn,u=Fn,d,h){super(null,o,a,l,c,u,s,r,d,h),this.isDataTexture=!0,this.image={data:t,width:e,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var ur=class extends Ge{constructor(t,e,n,s=1){super(t,e,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=s}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}toJSON(){let t=super.toJSON();return t.meshPerAttribute=this.meshPerAttribute,t.isInstancedBufferAttribute=!0,t}};var hr=new zs,Zx=new Vt(.5,.5),Ol=new H,Gs=class{constructor(t=new zn,e=new zn,n=new zn,s=new zn,r=new zn,o=new zn){this.planes=[t,e,n,s,r,o]}set(t,e,n,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let n=0;n<6;n++)e[n].copy(t.planes[n]);return this}setFromProjectionMatrix(t,e=Ei,n=!1){let s=this.planes,r=t.elements,o=r[0],a=r[1],l=r[2],c=r[3],u=r[4],d=r[5],h=r[6],f=r[7],p=r[8],v=r[9],m=r[10],g=r[11],S=r[12],M=r[13],y=r[14],C=r[15];if(s[0].setComponents(c-o,f-u,g-p,C-S).normalize(),s[1].setComponents(c+o,f+u,g+p,C+S).normalize(),s[2].setComponents(c+a,f+d,g+v,C+M).normalize(),s[3].setComponents(c-a,f-d,g-v,C-M).normalize(),n)s[4].setComponents(l,h,m,y).normalize(),s[5].setComponents(c-l,f-h,g-m,C-y).normalize();else if(s[4].setComponents(c-l,f-h,g-m,C-y).normalize(),e===Ei)s[5].setComponents(c+l,f+h,g+m,C+y).normalize();else if(e===ro)s[5].setComponents(l,h,m,y).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),hr.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),hr.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(hr)}intersectsSprite(t){hr.center.set(0,0,0);let e=Zx.distanceTo(t.center);return hr.radius=.7071067811865476+e,hr.applyMatrix4(t.matrixWorld),this.intersectsSphere(hr)}intersectsSphere(t){let e=this.planes,n=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let n=0;n<6;n++){let s=e[n];if(Ol.x=s.normal.x>0?t.max.x:t.min.x,Ol.y=s.normal.y>0?t.max.y:t.min.y,Ol.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(Ol)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let n=0;n<6;n++)if(e[n].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},gm=new Oe,cc=class i{constructor(){this.coordinateSystem=Ei,this._frustums=[],this._count=0}setFromArrayCamera(t){let e=t.cameras,n=this._frustums;for(let s=0;s<e.length;s++){let r=e[s];gm.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new Gs),n[s].setFromProjectionMatrix(gm,r.coordinateSystem,r.reversedDepth)}return this._count=e.length,this}getFrustum(t){return this._frustums[t]}intersectsObject(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsObject(t))return!0;return!1}intersectsSprite(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSprite(t))return!0;return!1}intersectsSphere(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSphere(t))return!0;return!1}intersectsBox(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsBox(t))return!0;return!1}containsPoint(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].containsPoint(t))return!0;return!1}copy(t){this.coordinateSystem=t.coordinateSystem;let e=this._frustums,n=t._frustums;for(let s=0;s<t._count;s++)e[s]===void 0&&(e[s]=new Gs),e[s].copy(n[s]);return this._count=t._count,this}clone(){return new i().copy(this)}};var Oi=class extends Fi{constructor(t){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Zt(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},hc=new H,uc=new H,_m=new Oe,ta=new _s,kl=new zs,Qu=new H,ym=new H,uo=class extends Sn{constructor(t=new Ve,e=new Oi){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[0];for(let s=1,r=e.count;s<r;s++)hc.fromBufferAttribute(e,s-1),uc.fromBufferAttribute(e,s),n[s]=n[s-1],n[s]+=hc.distanceTo(uc);t.setAttribute("lineDistance",new Re(n,1))}else Yt("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),kl.copy(n.boundingSphere),kl.applyMatrix4(s),kl.radius+=r,t.ray.intersectsSphere(kl)===!1)return;_m.copy(s).invert(),ta.copy(t.ray).applyMatrix4(_m);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,u=n.index,h=n.attributes.position;if(u!==null){let f=Math.max(0,o.start),p=Math.min(u.count,o.start+o.count);for(let v=f,m=p-1;v<m;v+=c){let g=u.getX(v),S=u.getX(v+1),M=Bl(this,t,ta,l,g,S,v);M&&e.push(M)}if(this.isLineLoop){let v=u.getX(p-1),m=u.getX(f),g=Bl(this,t,ta,l,v,m,p-1);g&&e.push(g)}}else{let f=Math.max(0,o.start),p=Math.min(h.count,o.start+o.count);for(let v=f,m=p-1;v<m;v+=c){let g=Bl(this,t,ta,l,v,v+1,v);g&&e.push(g)}if(this.isLineLoop){let v=Bl(this,t,ta,l,p-1,f,p-1);v&&e.push(v)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function Bl(i,t,e,n,s,r,o){let a=i.geometry.attributes.position;if(hc.fromBufferAttribute(a,s),uc.fromBufferAttribute(a,r),e.distanceSqToSegment(hc,uc,Qu,ym)>n)return;Qu.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(Qu);if(!(c<t.near||c>t.far))return{distance:c,point:ym.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var xm=new H,vm=new H,dr=class extends uo{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[];for(let s=0,r=e.count;s<r;s+=2)xm.fromBufferAttribute(e,s),vm.fromBufferAttribute(e,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+xm.distanceTo(vm);t.setAttribute("lineDistance",new Re(n,1))}else Yt("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}},pa=class extends uo{constructor(t,e){super(t,e),this.isLineLoop=!0,this.type="LineLoop"}},fo=class extends Fi{constructor(t){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new Zt(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.alphaMap=t.alphaMap,this.size=t.size,this.sizeAttenuation=t.sizeAttenuation,this.fog=t.fog,this}},bm=new Oe,od=new _s,zl=new zs,Hl=new H,ma=class extends Sn{constructor(t=new Ve,e=new fo){super(),this.isPoints=!0,this.type="Points",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Points.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),zl.copy(n.boundingSphere),zl.applyMatrix4(s),zl.radius+=r,t.ray.intersectsSphere(zl)===!1)return;bm.copy(s).invert(),od.copy(t.ray).applyMatrix4(bm);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=n.index,d=n.attributes.position;if(c!==null){let h=Math.max(0,o.start),f=Math.min(c.count,o.start+o.count);for(let p=h,v=f;p<v;p++){let m=c.getX(p);Hl.fromBufferAttribute(d,m),Sm(Hl,m,l,s,t,e,this)}}else{let h=Math.max(0,o.start),f=Math.min(d.count,o.start+o.count);for(let p=h,v=f;p<v;p++)Hl.fromBufferAttribute(d,p),Sm(Hl,p,l,s,t,e,this)}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function Sm(i,t,e,n,s,r,o){let a=od.distanceSqToPoint(i);if(a<e){let l=new H;od.closestPointToPoint(i,l),l.applyMatrix4(n);let c=s.ray.origin.distanceTo(l);if(c<s.near||c>s.far)return;r.push({distance:c,distanceToRay:Math.sqrt(a),point:l,index:t,face:null,faceIndex:null,barycoord:null,object:o})}}var ga=class extends oi{constructor(t=[],e=xr,n,s,r,o,a,l,c,u){super(t,e,n,s,r,o,a,l,c,u),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}};var ys=class extends oi{constructor(t,e,n=ki,s,r,o,a=Fn,l=Fn,c,u=gs,d=1){if(u!==gs&&u!==vs)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let h={width:t,height:e,depth:d};super(h,s,r,o,a,l,u,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.source=new lo(Object.assign({},t.image)),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return e.compareFunction=this.compareFunction,e}},_a=class extends ys{constructor(t,e=ki,n=xr,s,r,o=Fn,a=Fn,l,c=gs){let u={width:t,height:t,depth:1},d=[u,u,u,u,u,u];super(t,t,e,n,s,r,o,a,l,c),this.image=d,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(t){this.image=t}},ya=class extends oi{constructor(t=null){super(),this.sourceTexture=t,this.isExternalTexture=!0}copy(t){return super.copy(t),this.sourceTexture=t.sourceTexture,this}},Vs=class i extends Ve{constructor(t=1,e=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],u=[],d=[],h=0,f=0;p("z","y","x",-1,-1,n,e,t,o,r,0),p("z","y","x",1,-1,n,e,-t,o,r,1),p("x","z","y",1,1,t,n,e,s,o,2),p("x","z","y",1,-1,t,n,-e,s,o,3),p("x","y","z",1,-1,t,e,n,s,r,4),p("x","y","z",-1,-1,t,e,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Re(c,3)),this.setAttribute("normal",new Re(u,3)),this.setAttribute("uv",new Re(d,2));function p(v,m,g,S,M,y,C,A,x,E,F){let L=y/x,D=C/E,B=y/2,G=C/2,N=A/2,W=x+1,q=E+1,V=0,lt=0,Z=new H;for(let j=0;j<q;j++){let et=j*D-G;for(let dt=0;dt<W;dt++){let ut=dt*L-B;Z[v]=ut*S,Z[m]=et*M,Z[g]=N,c.push(Z.x,Z.y,Z.z),Z[v]=0,Z[m]=0,Z[g]=A>0?1:-1,u.push(Z.x,Z.y,Z.z),d.push(dt/x),d.push(1-j/E),V+=1}}for(let j=0;j<E;j++)for(let et=0;et<x;et++){let dt=h+et+W*j,ut=h+et+W*(j+1),tt=h+(et+1)+W*(j+1),mt=h+(et+1)+W*j;l.push(dt,ut,mt),l.push(ut,tt,mt),lt+=6}a.addGroup(f,lt,F),f+=lt,h+=V}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};var Ws=class i extends Ve{constructor(t=1,e=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:t,radiusBottom:e,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let u=[],d=[],h=[],f=[],p=0,v=[],m=n/2,g=0;S(),o===!1&&(t>0&&M(!0),e>0&&M(!1)),this.setIndex(u),this.setAttribute("position",new Re(d,3)),this.setAttribute("normal",new Re(h,3)),this.setAttribute("uv",new Re(f,2));function S(){let y=new H,C=new H,A=0,x=(e-t)/n;for(let E=0;E<=r;E++){let F=[],L=E/r,D=L*(e-t)+t;for(let B=0;B<=s;B++){let G=B/s,N=G*l+a,W=Math.sin(N),q=Math.cos(N);C.x=D*W,C.y=-L*n+m,C.z=D*q,d.push(C.x,C.y,C.z),y.set(W,x,q).normalize(),h.push(y.x,y.y,y.z),f.push(G,1-L),F.push(p++)}v.push(F)}for(let E=0;E<s;E++)for(let F=0;F<r;F++){let L=v[F][E],D=v[F+1][E],B=v[F+1][E+1],G=v[F][E+1];(t>0||F!==0)&&(u.push(L,D,G),A+=3),(e>0||F!==r-1)&&(u.push(D,B,G),A+=3)}c.addGroup(g,A,0),g+=A}function M(y){let C=p,A=new Vt,x=new H,E=0,F=y===!0?t:e,L=y===!0?1:-1;for(let B=1;B<=s;B++)d.push(0,m*L,0),h.push(0,L,0),f.push(.5,.5),p++;let D=p;for(let B=0;B<=s;B++){let N=B/s*l+a,W=Math.cos(N),q=Math.sin(N);x.x=F*q,x.y=m*L,x.z=F*W,d.push(x.x,x.y,x.z),h.push(0,L,0),A.x=W*.5+.5,A.y=q*.5*L+.5,f.push(A.x,A.y),p++}for(let B=0;B<s;B++){let G=C+B,N=D+B;y===!0?u.push(N,N+1,G):u.push(N+1,N,G),E+=3}c.addGroup(g,E,y===!0?1:2),g+=E}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radiusTop,t.radiusBottom,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},dc=class i extends Ws{constructor(t=1,e=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,t,e,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:t,height:e,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(t){return new i(t.radius,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},fc=class i extends Ve{constructor(t=[],e=[],n=1,s=0){super(),this.type="PolyhedronGeometry",this.parameters={vertices:t,indices:e,radius:n,detail:s};let r=[],o=[];a(s),c(n),u(),this.setAttribute("position",new Re(r,3)),this.setAttribute("normal",new Re(r.slice(),3)),this.setAttribute("uv",new Re(o,2)),s===0?this.computeVertexNormals():this.normalizeNormals();function a(S){let M=new H,y=new H,C=new H;for(let A=0;A<e.length;A+=3)f(e[A+0],M),f(e[A+1],y),f(e[A+2],C),l(M,y,C,S)}function l(S,M,y,C){let A=C+1,x=[];for(let E=0;E<=A;E++){x[E]=[];let F=S.clone().lerp(y,E/A),L=M.clone().lerp(y,E/A),D=A-E;for(let B=0;B<=D;B++)B===0&&E===A?x[E][B]=F:x[E][B]=F.clone().lerp(L,B/D)}for(let E=0;E<A;E++)for(let F=0;F<2*(A-E)-1;F++){let L=Math.floor(F/2);F%2===0?(h(x[E][L+1]),h(x[E+1][L]),h(x[E][L])):(h(x[E][L+1]),h(x[E+1][L+1]),h(x[E+1][L]))}}function c(S){let M=new H;for(let y=0;y<r.length;y+=3)M.x=r[y+0],M.y=r[y+1],M.z=r[y+2],M.normalize().multiplyScalar(S),r[y+0]=M.x,r[y+1]=M.y,r[y+2]=M.z}function u(){let S=new H;for(let M=0;M<r.length;M+=3){S.x=r[M+0],S.y=r[M+1],S.z=r[M+2];let y=m(S)/2/Math.PI+.5,C=g(S)/Math.PI+.5;o.push(y,1-C)}p(),d()}function d(){for(let S=0;S<o.length;S+=6){let M=o[S+0],y=o[S+2],C=o[S+4],A=Math.max(M,y,C),x=Math.min(M,y,C);A>.9&&x<.1&&(M<.2&&(o[S+0]+=1),y<.2&&(o[S+2]+=1),C<.2&&(o[S+4]+=1))}}function h(S){r.push(S.x,S.y,S.z)}function f(S,M){let y=S*3;M.x=t[y+0],M.y=t[y+1],M.z=t[y+2]}function p(){let S=new H,M=new H,y=new H,C=new H,A=new Vt,x=new Vt,E=new Vt;for(let F=0,L=0;F<r.length;F+=9,L+=6){S.set(r[F+0],r[F+1],r[F+2]),M.set(r[F+3],r[F+4],r[F+5]),y.set(r[F+6],r[F+7],r[F+8]),A.set(o[L+0],o[L+1]),x.set(o[L+2],o[L+3]),E.set(o[L+4],o[L+5]),C.copy(S).add(M).add(y).divideScalar(3);let D=m(C);v(A,L+0,S,D),v(x,L+2,M,D),v(E,L+4,y,D)}}function v(S,M,y,C){C<0&&S.x===1&&(o[M]=S.x-1),y.x===0&&y.z===0&&(o[M]=C/2/Math.PI+.5)}function m(S){return Math.atan2(S.z,-S.x)}function g(S){return Math.atan2(-S.y,Math.sqrt(S.x*S.x+S.z*S.z))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.vertices,t.indices,t.radius,t.detail)}};function Kx(i,t,e=2){let n=t&&t.length,s=n?t[0]*e:i.length,r=Sg(i,0,s,e,!0),o=[];if(!r||r.next===r.prev)return o;let a,l,c;if(n&&(r=ev(i,t,r,e)),i.length>80*e){a=i[0],l=i[1];let u=a,d=l;for(let h=e;h<s;h+=e){let f=i[h],p=i[h+1];f<a&&(a=f),p<l&&(l=p),f>u&&(u=f),p>d&&(d=p)}c=Math.max(u-a,d-l),c=c!==0?32767/c:0}return xa(r,o,e,a,l,c,0),o}function Sg(i,t,e,n,s){let r;if(s===dv(i,t,e,n)>0)for(let o=t;o<e;o+=n)r=Mm(o/n|0,i[o],i[o+1],r);else for(let o=e-n;o>=t;o-=n)r=Mm(o/n|0,i[o],i[o+1],r);return r&&po(r,r.next)&&(ba(r),r=r.next),r}function fr(i,t){if(!i)return i;t||(t=i);let e=i,n;do if(n=!1,!e.steiner&&(po(e,e.next)||en(e.prev,e,e.next)===0)){if(ba(e),e=t=e.prev,e===e.next)break;n=!0}else e=e.next;while(n||e!==t);return t}function xa(i,t,e,n,s,r,o){if(!i)return;!o&&r&&ov(i,n,s,r);let a=i;for(;i.prev!==i.next;){let l=i.prev,c=i.next;if(r?jx(i,n,s,r):Jx(i)){t.push(l.i,i.i,c.i),ba(i),i=c.next,a=c.next;continue}if(i=c,i===a){o?o===1?(i=Qx(fr(i),t),xa(i,t,e,n,s,r,2)):o===2&&tv(i,t,e,n,s,r):xa(fr(i),t,e,n,s,r,1);break}}}function Jx(i){let t=i.prev,e=i,n=i.next;if(en(t,e,n)>=0)return!1;let s=t.x,r=e.x,o=n.x,a=t.y,l=e.y,c=n.y,u=Math.min(s,r,o),d=Math.min(a,l,c),h=Math.max(s,r,o),f=Math.max(a,l,c),p=n.next;for(;p!==t;){if(p.x>=u&&p.x<=h&&p.y>=d&&p.y<=f&&ea(s,a,r,l,o,c,p.x,p.y)&&en(p.prev,p,p.next)>=0)return!1;p=p.next}return!0}function jx(i,t,e,n){let s=i.prev,r=i,o=i.next;if(en(s,r,o)>=0)return!1;let a=s.x,l=r.x,c=o.x,u=s.y,d=r.y,h=o.y,f=Math.min(a,l,c),p=Math.min(u,d,h),v=Math.max(a,l,c),m=Math.max(u,d,h),g=ad(f,p,t,e,n),S=ad(v,m,t,e,n),M=i.prevZ,y=i.nextZ;for(;M&&M.z>=g&&y&&y.z<=S;){if(M.x>=f&&M.x<=v&&M.y>=p&&M.y<=m&&M!==s&&M!==o&&ea(a,u,l,d,c,h,M.x,M.y)&&en(M.prev,M,M.next)>=0||(M=M.prevZ,y.x>=f&&y.x<=v&&y.y>=p&&y.y<=m&&y!==s&&y!==o&&ea(a,u,l,d,c,h,y.x,y.y)&&en(y.prev,y,y.next)>=0))return!1;y=y.nextZ}for(;M&&M.z>=g;){if(M.x>=f&&M.x<=v&&M.y>=p&&M.y<=m&&M!==s&&M!==o&&ea(a,u,l,d,c,h,M.x,M.y)&&en(M.prev,M,M.next)>=0)return!1;M=M.prevZ}for(;y&&y.z<=S;){if(y.x>=f&&y.x<=v&&y.y>=p&&y.y<=m&&y!==s&&y!==o&&ea(a,u,l,d,c,h,y.x,y.y)&&en(y.prev,y,y.next)>=0)return!1;y=y.nextZ}return!0}function Qx(i,t){let e=i;do{let n=e.prev,s=e.next.next;!po(n,s)&&wg(n,e,e.next,s)&&va(n,s)&&va(s,n)&&(t.push(n.i,e.i,s.i),ba(e),ba(e.next),e=i=s),e=e.next}while(e!==i);return fr(e)}function tv(i,t,e,n,s,r){let o=i;do{let a=o.next.next;for(;a!==o.prev;){if(o.i!==a.i&&cv(o,a)){let l=Eg(o,a);o=fr(o,o.next),l=fr(l,l.next),xa(o,t,e,n,s,r,0),xa(l,t,e,n,s,r,0);return}a=a.next}o=o.next}while(o!==i)}function ev(i,t,e,n){let s=[];for(let r=0,o=t.length;r<o;r++){let a=t[r]*n,l=r<o-1?t[r+1]*n:i.length,c=Sg(i,a,l,n,!1);c===c.next&&(c.steiner=!0),s.push(lv(c))}s.sort(nv);for(let r=0;r<s.length;r++)e=iv(s[r],e);return e}function nv(i,t){let e=i.x-t.x;if(e===0&&(e=i.y-t.y,e===0)){let n=(i.next.y-i.y)/(i.next.x-i.x),s=(t.next.y-t.y)/(t.next.x-t.x);e=n-s}return e}function iv(i,t){let e=sv(i,t);if(!e)return t;let n=Eg(e,i);return fr(n,n.next),fr(e,e.next)}function sv(i,t){let e=t,n=i.x,s=i.y,r=-1/0,o;if(po(i,e))return e;do{if(po(i,e.next))return e.next;if(s<=e.y&&s>=e.next.y&&e.next.y!==e.y){let d=e.x+(s-e.y)*(e.next.x-e.x)/(e.next.y-e.y);if(d<=n&&d>r&&(r=d,o=e.x<e.next.x?e:e.next,d===n))return o}e=e.next}while(e!==t);if(!o)return null;let a=o,l=o.x,c=o.y,u=1/0;e=o;do{if(n>=e.x&&e.x>=l&&n!==e.x&&Mg(s<c?n:r,s,l,c,s<c?r:n,s,e.x,e.y)){let d=Math.abs(s-e.y)/(n-e.x);va(e,i)&&(d<u||d===u&&(e.x>o.x||e.x===o.x&&rv(o,e)))&&(o=e,u=d)}e=e.next}while(e!==a);return o}function rv(i,t){return en(i.prev,i,t.prev)<0&&en(t.next,i,i.next)<0}function ov(i,t,e,n){let s=i;do s.z===0&&(s.z=ad(s.x,s.y,t,e,n)),s.prevZ=s.prev,s.nextZ=s.next,s=s.next;while(s!==i);s.prevZ.nextZ=null,s.prevZ=null,av(s)}function av(i){let t,e=1;do{let n=i,s;i=null;let r=null;for(t=0;n;){t++;let o=n,a=0;for(let c=0;c<e&&(a++,o=o.nextZ,!!o);c++);let l=e;for(;a>0||l>0&&o;)a!==0&&(l===0||!o||n.z<=o.z)?(s=n,n=n.nextZ,a--):(s=o,o=o.nextZ,l--),r?r.nextZ=s:i=s,s.prevZ=r,r=s;n=o}r.nextZ=null,e*=2}while(t>1);return i}function ad(i,t,e,n,s){return i=(i-e)*s|0,t=(t-n)*s|0,i=(i|i<<8)&16711935,i=(i|i<<4)&252645135,i=(i|i<<2)&858993459,i=(i|i<<1)&1431655765,t=(t|t<<8)&16711935,t=(t|t<<4)&252645135,t=(t|t<<2)&858993459,t=(t|t<<1)&1431655765,i|t<<1}function lv(i){let t=i,e=i;do(t.x<e.x||t.x===e.x&&t.y<e.y)&&(e=t),t=t.next;while(t!==i);return e}function Mg(i,t,e,n,s,r,o,a){return(s-o)*(t-a)>=(i-o)*(r-a)&&(i-o)*(n-a)>=(e-o)*(t-a)&&(e-o)*(r-a)>=(s-o)*(n-a)}function ea(i,t,e,n,s,r,o,a){return!(i===o&&t===a)&&Mg(i,t,e,n,s,r,o,a)}function cv(i,t){return i.next.i!==t.i&&i.prev.i!==t.i&&!hv(i,t)&&(va(i,t)&&va(t,i)&&uv(i,t)&&(en(i.prev,i,t.prev)||en(i,t.prev,t))||po(i,t)&&en(i.prev,i,i.next)>0&&en(t.prev,t,t.next)>0)}function en(i,t,e){return(t.y-i.y)*(e.x-t.x)-(t.x-i.x)*(e.y-t.y)}function po(i,t){return i.x===t.x&&i.y===t.y}function wg(i,t,e,n){let s=Vl(en(i,t,e)),r=Vl(en(i,t,n)),o=Vl(en(e,n,i)),a=Vl(en(e,n,t));return!!(s!==r&&o!==a||s===0&&Gl(i,e,t)||r===0&&Gl(i,n,t)||o===0&&Gl(e,i,n)||a===0&&Gl(e,t,n))}function Gl(i,t,e){return t.x<=Math.max(i.x,e.x)&&t.x>=Math.min(i.x,e.x)&&t.y<=Math.max(i.y,e.y)&&t.y>=Math.min(i.y,e.y)}function Vl(i){return i>0?1:i<0?-1:0}function hv(i,t){let e=i;do{if(e.i!==i.i&&e.next.i!==i.i&&e.i!==t.i&&e.next.i!==t.i&&wg(e,e.next,i,t))return!0;e=e.next}while(e!==i);return!1}function va(i,t){return en(i.prev,i,i.next)<0?en(i,t,i.next)>=0&&en(i,i.prev,t)>=0:en(i,t,i.prev)<0||en(i,i.next,t)<0}function uv(i,t){let e=i,n=!1,s=(i.x+t.x)/2,r=(i.y+t.y)/2;do e.y>r!=e.next.y>r&&e.next.y!==e.y&&s<(e.next.x-e.x)*(r-e.y)/(e.next.y-e.y)+e.x&&(n=!n),e=e.next;while(e!==i);return n}function Eg(i,t){let e=ld(i.i,i.x,i.y),n=ld(t.i,t.x,t.y),s=i.next,r=t.prev;return i.next=t,t.prev=i,e.next=s,s.prev=e,n.next=e,e.prev=n,r.next=n,n.prev=r,n}function Mm(i,t,e,n){let s=ld(i,t,e);return n?(s.next=n.next,s.prev=n,n.next.prev=s,n.next=s):(s.prev=s,s.next=s),s}function ba(i){i.next.prev=i.prev,i.prev.next=i.next,i.prevZ&&(i.prevZ.nextZ=i.nextZ),i.nextZ&&(i.nextZ.prevZ=i.prevZ)}function ld(i,t,e){return{i,x:t,y:e,prev:null,next:null,z:0,prevZ:null,nextZ:null,steiner:!1}}function dv(i,t,e,n){let s=0;for(let r=t,o=e-n;r<e;r+=n)s+=(i[o]-i[r])*(i[r+1]+i[o+1]),o=r;return s}var cd=class{static triangulate(t,e,n=2){return Kx(t,e,n)}},mo=class i{static area(t){let e=t.length,n=0;for(let s=e-1,r=0;r<e;s=r++)n+=t[s].x*t[r].y-t[r].x*t[s].y;return n*.5}static isClockWise(t){return i.area(t)<0}static triangulateShape(t,e){let n=[],s=[],r=[];wm(t),Em(n,t);let o=t.length;e.forEach(wm);for(let l=0;l<e.length;l++)s.push(o),o+=e[l].length,Em(n,e[l]);let a=cd.triangulate(n,s);for(let l=0;l<a.length;l+=3)r.push(a.slice(l,l+3));return r}};function wm(i){let t=i.length;t>2&&i[t-1].equals(i[0])&&i.pop()}function Em(i,t){for(let e=0;e<t.length;e++)i.push(t[e].x),i.push(t[e].y)}var Sa=class i extends fc{constructor(t=1,e=0){let n=(1+Math.sqrt(5))/2,s=[-1,n,0,1,n,0,-1,-n,0,1,-n,0,0,-1,n,0,1,n,0,-1,-n,0,1,-n,n,0,-1,n,0,1,-n,0,-1,-n,0,1],r=[0,11,5,0,5,1,0,1,7,0,7,10,0,10,11,1,5,9,5,11,4,11,10,2,10,7,6,7,1,8,3,9,4,3,4,2,3,2,6,3,6,8,3,8,9,4,9,5,2,4,11,6,2,10,8,6,7,9,8,1];super(s,r,t,e),this.type="IcosahedronGeometry",this.parameters={radius:t,detail:e}}static fromJSON(t){return new i(t.radius,t.detail)}};var pr=class i extends Ve{constructor(t=1,e=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:n,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(n),l=Math.floor(s),c=a+1,u=l+1,d=t/a,h=e/l,f=[],p=[],v=[],m=[];for(let g=0;g<u;g++){let S=g*h-o;for(let M=0;M<c;M++){let y=M*d-r;p.push(y,-S,0),v.push(0,0,1),m.push(M/a),m.push(1-g/l)}}for(let g=0;g<l;g++)for(let S=0;S<a;S++){let M=S+c*g,y=S+c*(g+1),C=S+1+c*(g+1),A=S+1+c*g;f.push(M,y,A),f.push(y,C,A)}this.setIndex(f),this.setAttribute("position",new Re(p,3)),this.setAttribute("normal",new Re(v,3)),this.setAttribute("uv",new Re(m,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.widthSegments,t.heightSegments)}},mr=class i extends Ve{constructor(t=.5,e=1,n=32,s=1,r=0,o=Math.PI*2){super(),this.type="RingGeometry",this.parameters={innerRadius:t,outerRadius:e,thetaSegments:n,phiSegments:s,thetaStart:r,thetaLength:o},n=Math.max(3,n),s=Math.max(1,s);let a=[],l=[],c=[],u=[],d=t,h=(e-t)/s,f=new H,p=new Vt;for(let v=0;v<=s;v++){for(let m=0;m<=n;m++){let g=r+m/n*o;f.x=d*Math.cos(g),f.y=d*Math.sin(g),l.push(f.x,f.y,f.z),c.push(0,0,1),p.x=(f.x/e+1)/2,p.y=(f.y/e+1)/2,u.push(p.x,p.y)}d+=h}for(let v=0;v<s;v++){let m=v*(n+1);for(let g=0;g<n;g++){let S=g+m,M=S,y=S+n+1,C=S+n+2,A=S+1;a.push(M,y,A),a.push(y,C,A)}}this.setIndex(a),this.setAttribute("position",new Re(l,3)),this.setAttribute("normal",new Re(c,3)),this.setAttribute("uv",new Re(u,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.innerRadius,t.outerRadius,t.thetaSegments,t.phiSegments,t.thetaStart,t.thetaLength)}};function br(i){let t={};for(let e in i){t[e]={};for(let n in i[e]){let s=i[e][n];if(Tm(s))s.isRenderTargetTexture?(Yt("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][n]=null):t[e][n]=s.clone();else if(Array.isArray(s))if(Tm(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();t[e][n]=r}else t[e][n]=s.slice();else t[e][n]=s}}return t}function qn(i){let t={};for(let e=0;e<i.length;e++){let n=br(i[e]);for(let s in n)t[s]=n[s]}return t}function Tm(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function fv(i){let t=[];for(let e=0;e<i.length;e++)t.push(i[e].clone());return t}function Vd(i){let t=i.getRenderTarget();return t===null?i.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:_e.workingColorSpace}var Tg={clone:br,merge:qn},pv=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,mv=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Ti=class extends Fi{constructor(t){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=pv,this.fragmentShader=mv,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=br(t.uniforms),this.uniformsGroups=fv(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this.defaultAttributeValues=Object.assign({},t.defaultAttributeValues),this.index0AttributeName=t.index0AttributeName,this.uniformsNeedUpdate=t.uniformsNeedUpdate,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(e.extensions=n),e}fromJSON(t,e){if(super.fromJSON(t,e),t.uniforms!==void 0)for(let n in t.uniforms){let s=t.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=e[s.value]||null;break;case"c":this.uniforms[n].value=new Zt().setHex(s.value);break;case"v2":this.uniforms[n].value=new Vt().fromArray(s.value);break;case"v3":this.uniforms[n].value=new H().fromArray(s.value);break;case"v4":this.uniforms[n].value=new je().fromArray(s.value);break;case"m3":this.uniforms[n].value=new ne().fromArray(s.value);break;case"m4":this.uniforms[n].value=new Oe().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(t.defines!==void 0&&(this.defines=t.defines),t.vertexShader!==void 0&&(this.vertexShader=t.vertexShader),t.fragmentShader!==void 0&&(this.fragmentShader=t.fragmentShader),t.glslVersion!==void 0&&(this.glslVersion=t.glslVersion),t.extensions!==void 0)for(let n in t.extensions)this.extensions[n]=t.extensions[n];return t.lights!==void 0&&(this.lights=t.lights),t.clipping!==void 0&&(this.clipping=t.clipping),this}},pc=class extends Ti{constructor(t){super(t),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}},Xs=class extends Fi{constructor(t){super(),this.isMeshStandardMaterial=!0,this.type="MeshStandardMaterial",this.defines={STANDARD:""},this.color=new Zt(16777215),this.roughness=1,this.metalness=0,this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new Zt(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Ba,this.normalScale=new Vt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.roughnessMap=null,this.metalnessMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ji,this.envMapIntensity=1,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.defines={STANDARD:""},this.color.copy(t.color),this.roughness=t.roughness,this.metalness=t.metalness,this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.roughnessMap=t.roughnessMap,this.metalnessMap=t.metalnessMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.envMapIntensity=t.envMapIntensity,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}};var Xn=class extends Fi{constructor(t){super(),this.isMeshLambertMaterial=!0,this.type="MeshLambertMaterial",this.color=new Zt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new Zt(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Ba,this.normalScale=new Vt(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new ji,this.combine=Rc,this.reflectivity=1,this.envMapIntensity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.emissive.copy(t.emissive),this.emissiveMap=t.emissiveMap,this.emissiveIntensity=t.emissiveIntensity,this.bumpMap=t.bumpMap,this.bumpScale=t.bumpScale,this.normalMap=t.normalMap,this.normalMapType=t.normalMapType,this.normalScale.copy(t.normalScale),this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.envMapIntensity=t.envMapIntensity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.flatShading=t.flatShading,this.fog=t.fog,this}},go=class extends Fi{constructor(t){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=og,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},mc=class extends Fi{constructor(t){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}};var Ma=class extends Oi{constructor(t){super(),this.isLineDashedMaterial=!0,this.type="LineDashedMaterial",this.scale=1,this.dashSize=3,this.gapSize=1,this.setValues(t)}copy(t){return super.copy(t),this.scale=t.scale,this.dashSize=t.dashSize,this.gapSize=t.gapSize,this}};function to(i,t){return!i||i.constructor===t?i:typeof t.BYTES_PER_ELEMENT=="number"?new t(i):Array.prototype.slice.call(i)}function Wl(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var $s=class{constructor(t,e,n,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(n),this.sampleValues=e,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,n=this._cachedIndex,s=e[n],r=e[n-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=n+2;;){if(s===void 0){if(t<r)break i;return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=e[++n],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=e[--n-1],t>=r)break t}o=n,n=0;break e}break n}for(;n<o;){let a=n+o>>>1;t<e[a]?o=a:n=a+1}if(s=e[n],r=e[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=n[r+o];return e}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},gc=class extends $s{constructor(t,e,n,s){super(t,e,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:id,endingEnd:id}}intervalChanged_(t,e,n){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case sd:r=t,a=2*e-n;break;case rd:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case sd:o=t,l=2*n-e;break;case rd:o=1,l=n+s[1]-s[0];break;default:o=t-1,l=e}let c=(n-e)*.5,u=this.valueSize;this._weightPrev=c/(e-a),this._weightNext=c/(l-n),this._offsetPrev=r*u,this._offsetNext=o*u}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,u=this._offsetPrev,d=this._offsetNext,h=this._weightPrev,f=this._weightNext,p=(n-e)/(s-e),v=p*p,m=v*p,g=-h*m+2*h*v-h*p,S=(1+h)*m+(-1.5-2*h)*v+(-.5+h)*p+1,M=(-1-f)*m+(1.5+f)*v+.5*p,y=f*m-f*v;for(let C=0;C!==a;++C)r[C]=g*o[u+C]+S*o[c+C]+M*o[l+C]+y*o[d+C];return r}},_c=class extends $s{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,u=(n-e)/(s-e),d=1-u;for(let h=0;h!==a;++h)r[h]=o[c+h]*d+o[l+h]*u;return r}},yc=class extends $s{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t){return this.copySampleValue_(t-1)}},xc=class extends $s{interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,u=this.inTangents,d=this.outTangents;if(!u||!d){let p=(n-e)/(s-e),v=1-p;for(let m=0;m!==a;++m)r[m]=o[c+m]*v+o[l+m]*p;return r}let h=a*2,f=t-1;for(let p=0;p!==a;++p){let v=o[c+p],m=o[l+p],g=f*h+p*2,S=d[g],M=d[g+1],y=t*h+p*2,C=u[y],A=u[y+1],x=_v(n,e,S,C,s);r[p]=Ag(x,v,M,A,m)}return r}};function Ag(i,t,e,n,s){let r=1-i;return r*r*r*t+3*r*r*i*e+3*r*i*i*n+i*i*i*s}function gv(i,t,e,n,s){let r=1-i;return 3*r*r*(e-t)+6*r*i*(n-e)+3*i*i*(s-n)}function _v(i,t,e,n,s){let r=(i-t)/(s-t);for(let o=0;o<8;o++){let a=Ag(r,t,e,n,s)-i;if(Math.abs(a)<1e-10)break;let l=gv(r,t,e,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var yi=class{constructor(t,e,n,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=to(e,this.TimeBufferType),this.values=to(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,n;if(e.toJSON!==this.toJSON)n=e.toJSON(t);else{n={name:t.name,times:to(t.times,Array),values:to(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(n.interpolation=s),Wl(t.settings)&&(n.settings={inTangents:to(t.settings.inTangents,Array),outTangents:to(t.settings.outTangents,Array)})}return n.type=t.ValueTypeName,n}InterpolantFactoryMethodDiscrete(t){return new yc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new _c(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new gc(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodBezier(t){let e=new xc(this.times,this.values,this.getValueSize(),t);return this.settings&&(e.inTangents=this.settings.inTangents,e.outTangents=this.settings.outTangents),e}setInterpolation(t){let e;switch(t){case ra:e=this.InterpolantFactoryMethodDiscrete;break;case rc:e=this.InterpolantFactoryMethodLinear;break;case Yl:e=this.InterpolantFactoryMethodSmooth;break;case nd:e=this.InterpolantFactoryMethodBezier;break}if(e===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return Yt("KeyframeTrack:",n),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return ra;case this.InterpolantFactoryMethodLinear:return rc;case this.InterpolantFactoryMethodSmooth:return Yl;case this.InterpolantFactoryMethodBezier:return nd}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]+=t;Wl(this.settings)&&(Am(this.settings.inTangents,t),Am(this.settings.outTangents,t))}return this}scale(t){if(t!==1){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]*=t;Wl(this.settings)&&(Rm(this.settings.inTangents,t),Rm(this.settings.outTangents,t))}return this}trim(t,e){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<t;)++r;for(;o!==-1&&n[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(te("KeyframeTrack: Invalid value size in track.",this),t=!1);let n=this.times,s=this.values,r=n.length;r===0&&(te("KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){te("KeyframeTrack: Time is not a valid number.",this,a,l),t=!1;break}if(o!==null&&o>l){te("KeyframeTrack: Out of order keys.",this,a,l,o),t=!1;break}o=l}if(s!==void 0&&gx(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){te("KeyframeTrack: Value is not a valid number.",this,a,c),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===Yl,r=t.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=t[a],u=t[a+1];if(c!==u&&(a!==1||c!==t[0]))if(s)l=!0;else{let d=a*n,h=d-n,f=d+n;for(let p=0;p!==n;++p){let v=e[d+p];if(v!==e[h+p]||v!==e[f+p]){l=!0;break}}}if(l){if(a!==o){t[o]=t[a];let d=a*n,h=o*n;for(let f=0;f!==n;++f)e[h+f]=e[d+f]}++o}}if(r>0){t[o]=t[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)e[l+c]=e[a+c];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*n)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),n=this.constructor,s=new n(this.name,t,e);return s.createInterpolant=this.createInterpolant,Wl(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function Am(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]+=t}function Rm(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]*=t}yi.prototype.ValueTypeName="";yi.prototype.TimeBufferType=Float32Array;yi.prototype.ValueBufferType=Float32Array;yi.prototype.DefaultInterpolation=rc;var qs=class extends yi{constructor(t,e,n){super(t,e,n)}};qs.prototype.ValueTypeName="bool";qs.prototype.ValueBufferType=Array;qs.prototype.DefaultInterpolation=ra;qs.prototype.InterpolantFactoryMethodLinear=void 0;qs.prototype.InterpolantFactoryMethodSmooth=void 0;var vc=class extends yi{constructor(t,e,n,s){super(t,e,n,s)}};vc.prototype.ValueTypeName="color";var bc=class extends yi{constructor(t,e,n,s){super(t,e,n,s)}};bc.prototype.ValueTypeName="number";var Sc=class extends $s{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-e)/(s-e),c=t*a;for(let u=c+a;c!==u;c+=4)ni.slerpFlat(r,0,o,c-a,o,c,l);return r}},wa=class extends yi{constructor(t,e,n,s){super(t,e,n,s)}InterpolantFactoryMethodLinear(t){return new Sc(this.times,this.values,this.getValueSize(),t)}};wa.prototype.ValueTypeName="quaternion";wa.prototype.InterpolantFactoryMethodSmooth=void 0;var Ys=class extends yi{constructor(t,e,n){super(t,e,n)}};Ys.prototype.ValueTypeName="string";Ys.prototype.ValueBufferType=Array;Ys.prototype.DefaultInterpolation=ra;Ys.prototype.InterpolantFactoryMethodLinear=void 0;Ys.prototype.InterpolantFactoryMethodSmooth=void 0;var Mc=class extends yi{constructor(t,e,n,s){super(t,e,n,s)}};Mc.prototype.ValueTypeName="vector";var wc=class{constructor(t,e,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=n,this._abortController=null,this.itemStart=function(u){a++,r===!1&&s.onStart!==void 0&&s.onStart(u,o,a),r=!0},this.itemEnd=function(u){o++,s.onProgress!==void 0&&s.onProgress(u,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(u){s.onError!==void 0&&s.onError(u)},this.resolveURL=function(u){return u=u.normalize("NFC"),l?l(u):u},this.setURLModifier=function(u){return l=u,this},this.addHandler=function(u,d){return c.push(u,d),this},this.removeHandler=function(u){let d=c.indexOf(u);return d!==-1&&c.splice(d,2),this},this.getHandler=function(u){for(let d=0,h=c.length;d<h;d+=2){let f=c[d],p=c[d+1];if(f.global&&(f.lastIndex=0),f.test(u))return p}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},Rg=new wc,Ec=class{constructor(t){this.manager=t!==void 0?t:Rg,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(t,e){let n=this;return new Promise(function(s,r){n.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}setPriority(t){return this.priority=t,this}setCache(t){return this.cache=t,this}abort(){return this}};Ec.DEFAULT_MATERIAL_NAME="__DEFAULT";var Ea=class extends Sn{static registerNode(t){this.prototype._lightNode=t}constructor(t,e=1){super(),this.isLight=!0,this.type="Light",this.color=new Zt(t),this.intensity=e}copy(t,e){return super.copy(t,e),this.color.copy(t.color),this.intensity=t.intensity,this}toJSON(t){let e=super.toJSON(t);return e.object.color=this.color.getHex(),e.object.intensity=this.intensity,e}},Ta=class extends Ea{constructor(t,e,n){super(t,n),this.isHemisphereLight=!0,this.type="HemisphereLight",this.position.copy(Sn.DEFAULT_UP),this.updateMatrix(),this.groundColor=new Zt(e)}copy(t,e){return super.copy(t,e),this.groundColor.copy(t.groundColor),this}toJSON(t){let e=super.toJSON(t);return e.object.groundColor=this.groundColor.getHex(),e}},td=new Oe,Cm=new H,Pm=new H,Tc=class{constructor(t){this.camera=t,this.intensity=1,this.bias=0,this.biasNode=null,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new Vt(512,512),this.mapType=ai,this.map=null,this.mapPass=null,this.matrix=new Oe,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new Gs,this._frameExtents=new Vt(1,1),this._viewportCount=1,this._viewports=[new je(0,0,1,1)]}getViewportCount(){return this._viewportCount}getCamera(){return this.camera}getFrustum(){return this._frustum}updateMatrices(t){let e=this.camera;Cm.setFromMatrixPosition(t.matrixWorld),e.position.copy(Cm),Pm.setFromMatrixPosition(t.target.matrixWorld),e.lookAt(Pm),e.updateMatrixWorld(),this._updateMatrix(e,this.matrix,this._frustum)}_updateMatrix(t,e,n,s){td.multiplyMatrices(t.projectionMatrix,t.matrixWorldInverse),n.setFromProjectionMatrix(td,t.coordinateSystem,t.reversedDepth);let r=this._frameExtents,o=s?s.z/r.x:1,a=s?s.w/r.y:1,l=s?s.x/r.x:0,c=s?s.y/r.y:0;t.coordinateSystem===ro||t.reversedDepth?e.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,1,0,0,0,0,1):e.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,.5,.5,0,0,0,1),e.multiply(td)}getViewport(t){return this._viewports[t]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(t){return this.camera=t.camera.clone(),this.intensity=t.intensity,this.bias=t.bias,this.radius=t.radius,this.autoUpdate=t.autoUpdate,this.needsUpdate=t.needsUpdate,this.normalBias=t.normalBias,this.blurSamples=t.blurSamples,this.mapSize.copy(t.mapSize),this.mapType=t.mapType,this.biasNode=t.biasNode,this}clone(){return new this.constructor().copy(this)}toJSON(){let t={};return t.intensity=this.intensity,t.bias=this.bias,t.normalBias=this.normalBias,t.radius=this.radius,t.blurSamples=this.blurSamples,t.mapSize=this.mapSize.toArray(),t.mapType=this.mapType,t.camera=this.camera.toJSON(!1).object,delete t.camera.matrix,t}},Xl=new H,$l=new ni,Ki=new H,Aa=class extends Sn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Oe,this.projectionMatrix=new Oe,this.projectionMatrixInverse=new Oe,this.coordinateSystem=Ei,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorld.decompose(Xl,$l,Ki),Ki.x===1&&Ki.y===1&&Ki.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(Xl,$l,Ki.set(1,1,1)).invert()}updateWorldMatrix(t,e,n=!1){super.updateWorldMatrix(t,e,n),this.matrixWorld.decompose(Xl,$l,Ki),Ki.x===1&&Ki.y===1&&Ki.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(Xl,$l,Ki.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},Os=new H,Im=new Vt,Lm=new Vt,ti=class extends Aa{constructor(t=50,e=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=ao*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(ia*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return ao*2*Math.atan(Math.tan(ia*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,n){Os.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set(Os.x,Os.y).multiplyScalar(-t/Os.z),Os.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(Os.x,Os.y).multiplyScalar(-t/Os.z)}getViewSize(t,e){return this.getViewBounds(t,Im,Lm),e.subVectors(Lm,Im)}setViewOffset(t,e,n,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(ia*.5*this.fov)/this.zoom,n=2*e,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,e-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-n,t,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}};var Ra=class extends Aa{constructor(t=-1,e=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-t,o=n+t,a=s+e,l=s-e;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,u=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=u*this.view.offsetY,l=a-u*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}},hd=class extends Tc{constructor(){super(new Ra(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},Ca=class extends Ea{constructor(t,e){super(t,e),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(Sn.DEFAULT_UP),this.updateMatrix(),this.target=new Sn,this.shadow=new hd}dispose(){super.dispose(),this.shadow.dispose()}copy(t){return super.copy(t),this.target=t.target.clone(),this.shadow=t.shadow.clone(),this}toJSON(t){let e=super.toJSON(t);return e.object.shadow=this.shadow.toJSON(),e.object.target=this.target.uuid,e}};var _o=class extends Ve{constructor(){super(),this.isInstancedBufferGeometry=!0,this.type="InstancedBufferGeometry",this.instanceCount=1/0}copy(t){return super.copy(t),this.instanceCount=t.instanceCount,this}toJSON(){let t=super.toJSON();return t.instanceCount=this.instanceCount,t.isInstancedBufferGeometry=!0,t}};var eo=-90,no=1,yo=class extends Sn{constructor(t,e,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new ti(eo,no,t,e);s.layers=this.layers,this.add(s);let r=new ti(eo,no,t,e);r.layers=this.layers,this.add(r);let o=new ti(eo,no,t,e);o.layers=this.layers,this.add(o);let a=new ti(eo,no,t,e);a.layers=this.layers,this.add(a);let l=new ti(eo,no,t,e);l.layers=this.layers,this.add(l);let c=new ti(eo,no,t,e);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[n,s,r,o,a,l]=e;for(let c of e)this.remove(c);if(t===Ei)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(t===ro)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let c of e)this.add(c),c.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,u]=this.children,d=t.getRenderTarget(),h=t.getActiveCubeFace(),f=t.getActiveMipmapLevel(),p=t.xr.enabled;t.xr.enabled=!1;let v=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let m=!1;t.isWebGLRenderer===!0?m=t.state.buffers.depth.getReversed():m=t.reversedDepthBuffer,t.setRenderTarget(n,0,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,r),t.setRenderTarget(n,1,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,o),t.setRenderTarget(n,2,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,a),t.setRenderTarget(n,3,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,l),t.setRenderTarget(n,4,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,c),n.texture.mipmapsAutoUpdate=v,t.setRenderTarget(n,5,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,u),t.setRenderTarget(d,h,f),t.xr.enabled=p,n.texture.needsPMREMUpdate=!0}},Ac=class extends ti{constructor(t=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=t,this.perCameraFrustumCulled=!1}};var Wd="\\[\\]\\.:\\/",yv=new RegExp("["+Wd+"]","g"),Xd="[^"+Wd+"]",xv="[^"+Wd.replace("\\.","")+"]",vv=/((?:WC+[\/:])*)/.source.replace("WC",Xd),bv=/(WCOD+)?/.source.replace("WCOD",xv),Sv=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",Xd),Mv=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",Xd),wv=new RegExp("^"+vv+bv+Sv+Mv+"$"),Ev=["material","materials","bones","map"],ud=class{constructor(t,e,n){let s=n||Ye.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(t,e)}setValue(t,e){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].unbind()}},Ye=class i{constructor(t,e,n){this.path=e,this.parsedPath=n||i.parseTrackName(e),this.node=i.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,n){return t&&t.isAnimationObjectGroup?new i.Composite(t,e,n):new i(t,e,n)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(yv,"")}static parseTrackName(t){let e=wv.exec(t);if(e===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+t);let n={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);Ev.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+t);return n}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let n=t.skeleton.getBoneByName(e);if(n!==void 0)return n}if(t.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let l=n(a.children);if(l)return l}return null},s=n(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)t[e++]=n[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,n=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=i.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){Yt("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=e.objectIndex;switch(n){case"materials":if(!t.material){te("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){te("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){te("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let u=0;u<t.length;u++)if(t[u].name===c){c=u;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){te("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){te("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[n]===void 0){te("PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[n]}if(c!==void 0){if(t[c]===void 0){te("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[c]}}let o=t[s];if(o===void 0){let c=e.nodeName;te("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?a=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){te("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){te("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};Ye.Composite=ud;Ye.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};Ye.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};Ye.prototype.GetterByBindingType=[Ye.prototype._getValue_direct,Ye.prototype._getValue_array,Ye.prototype._getValue_arrayElement,Ye.prototype._getValue_toArray];Ye.prototype.SetterByBindingTypeAndVersioning=[[Ye.prototype._setValue_direct,Ye.prototype._setValue_direct_setNeedsUpdate,Ye.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[Ye.prototype._setValue_array,Ye.prototype._setValue_array_setNeedsUpdate,Ye.prototype._setValue_array_setMatrixWorldNeedsUpdate],[Ye.prototype._setValue_arrayElement,Ye.prototype._setValue_arrayElement_setNeedsUpdate,Ye.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[Ye.prototype._setValue_fromArray,Ye.prototype._setValue_fromArray_setNeedsUpdate,Ye.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var tC=new Float32Array(1);var Dm=new Oe,Zs=class{constructor(t,e,n=0,s=1/0){this.ray=new _s(t,e),this.near=n,this.far=s,this.camera=null,this.layers=new co,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(t,e){this.ray.set(t,e)}setFromCamera(t,e){e.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(t.x,t.y,.5).unproject(e).sub(this.ray.origin).normalize(),this.camera=e):e.isOrthographicCamera?(this.ray.origin.set(t.x,t.y,e.projectionMatrix.elements[14]).unproject(e),this.ray.direction.set(0,0,-1).transformDirection(e.matrixWorld),this.camera=e):te("Raycaster: Unsupported camera type: "+e.type)}setFromXRController(t){return Dm.identity().extractRotation(t.matrixWorld),this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(Dm),this}intersectObject(t,e=!0,n=[]){return dd(t,this,n,e),n.sort(Nm),n}intersectObjects(t,e=!0,n=[]){for(let s=0,r=t.length;s<r;s++)dd(t[s],this,n,e);return n.sort(Nm),n}};function Nm(i,t){return i.distance-t.distance}function dd(i,t,e,n){let s=!0;if(i.layers.test(t.layers)&&i.raycast(t,e)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)dd(r[o],t,e,!0)}}var Ks=class{constructor(t=1,e=0,n=0){this.radius=t,this.phi=e,this.theta=n}set(t,e,n){return this.radius=t,this.phi=e,this.theta=n,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=pe(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,n){return this.radius=Math.sqrt(t*t+e*e+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,n),this.phi=Math.acos(pe(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var fd=class{static{this.prototype.isMatrix2=!0}constructor(t,e,n,s){this.elements=[1,0,0,1],t!==void 0&&this.set(t,e,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(t,e=0){for(let n=0;n<4;n++)this.elements[n]=t[n+e];return this}set(t,e,n,s){let r=this.elements;return r[0]=t,r[2]=e,r[1]=n,r[3]=s,this}};var Um=new H,ql,ed,Pa=class extends Sn{constructor(t=new H(0,0,1),e=new H(0,0,0),n=1,s=16776960,r=n*.2,o=r*.2){super(),this.type="ArrowHelper",ql===void 0&&(ql=new Ve,ql.setAttribute("position",new Re([0,0,0,0,1,0],3)),ed=new dc(.5,1,5,1),ed.translate(0,-.5,0)),this.position.copy(e),this.line=new uo(ql,new Oi({color:s,toneMapped:!1})),this.line.matrixAutoUpdate=!1,this.add(this.line),this.cone=new ke(ed,new _i({color:s,toneMapped:!1})),this.cone.matrixAutoUpdate=!1,this.add(this.cone),this.setDirection(t),this.setLength(n,r,o)}setDirection(t){if(t.y>.99999)this.quaternion.set(0,0,0,1);else if(t.y<-.99999)this.quaternion.set(1,0,0,0);else{Um.set(t.z,0,-t.x).normalize();let e=Math.acos(t.y);this.quaternion.setFromAxisAngle(Um,e)}}setLength(t,e=t*.2,n=e*.2){this.line.scale.set(1,Math.max(1e-4,t-e),1),this.line.updateMatrix(),this.cone.scale.set(n,e,n),this.cone.position.y=t,this.cone.updateMatrix()}setColor(t){this.line.material.color.set(t),this.cone.material.color.set(t)}copy(t){return super.copy(t,!1),this.line.copy(t.line),this.cone.copy(t.cone),this}dispose(){super.dispose(),this.line.geometry.dispose(),this.line.material.dispose(),this.cone.geometry.dispose(),this.cone.material.dispose()}};var Ia=class extends Ui{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(t){this.domElement!==null&&this.disconnect(),this.domElement=t}disconnect(){}dispose(){}update(){}};function $d(i,t,e,n){let s=Tv(n);switch(e){case Ld:return i*t;case Nd:return i*t/s.components*s.byteLength;case Uc:return i*t/s.components*s.byteLength;case tr:return i*t*2/s.components*s.byteLength;case Fc:return i*t*2/s.components*s.byteLength;case Dd:return i*t*3/s.components*s.byteLength;case si:return i*t*4/s.components*s.byteLength;case Oc:return i*t*4/s.components*s.byteLength;case Da:case Na:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case Ua:case Fa:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Bc:case Hc:return Math.max(i,16)*Math.max(t,8)/4;case kc:case zc:return Math.max(i,8)*Math.max(t,8)/2;case Gc:case Vc:case Xc:case $c:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case Wc:case Oa:case qc:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Yc:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Zc:return Math.floor((i+4)/5)*Math.floor((t+3)/4)*16;case Kc:return Math.floor((i+4)/5)*Math.floor((t+4)/5)*16;case Jc:return Math.floor((i+5)/6)*Math.floor((t+4)/5)*16;case jc:return Math.floor((i+5)/6)*Math.floor((t+5)/6)*16;case Qc:return Math.floor((i+7)/8)*Math.floor((t+4)/5)*16;case th:return Math.floor((i+7)/8)*Math.floor((t+5)/6)*16;case eh:return Math.floor((i+7)/8)*Math.floor((t+7)/8)*16;case nh:return Math.floor((i+9)/10)*Math.floor((t+4)/5)*16;case ih:return Math.floor((i+9)/10)*Math.floor((t+5)/6)*16;case sh:return Math.floor((i+9)/10)*Math.floor((t+7)/8)*16;case rh:return Math.floor((i+9)/10)*Math.floor((t+9)/10)*16;case oh:return Math.floor((i+11)/12)*Math.floor((t+9)/10)*16;case ah:return Math.floor((i+11)/12)*Math.floor((t+11)/12)*16;case lh:case ch:case hh:return Math.ceil(i/4)*Math.ceil(t/4)*16;case uh:case dh:return Math.ceil(i/4)*Math.ceil(t/4)*8;case ka:case fh:return Math.ceil(i/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function Tv(i){switch(i){case ai:case Rd:return{byteLength:1,components:1};case So:case Cd:case Bi:return{byteLength:2,components:1};case Dc:case Nc:return{byteLength:2,components:4};case ki:case Lc:case li:return{byteLength:4,components:1};case Pd:case Id:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Yt("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function Kg(){let i=null,t=!1,e=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),e(r,o)}return{start:function(){t!==!0&&e!==null&&i!==null&&(n=i.requestAnimationFrame(s),t=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){i=r}}}function Dv(i){let t=new WeakMap;function e(a,l){let c=a.array,u=a.usage,d=c.byteLength,h=i.createBuffer();i.bindBuffer(l,h),i.bufferData(l,c,u),a.onUploadCallback();let f;if(c instanceof Float32Array)f=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)f=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?f=i.HALF_FLOAT:f=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)f=i.SHORT;else if(c instanceof Uint32Array)f=i.UNSIGNED_INT;else if(c instanceof Int32Array)f=i.INT;else if(c instanceof Int8Array)f=i.BYTE;else if(c instanceof Uint8Array)f=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)f=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:h,type:f,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:d}}function n(a,l,c){let u=l.array,d=l.updateRanges;if(i.bindBuffer(c,a),d.length===0)i.bufferSubData(c,0,u);else{d.sort((f,p)=>f.start-p.start);let h=0;for(let f=1;f<d.length;f++){let p=d[h],v=d[f];v.start<=p.start+p.count+1?p.count=Math.max(p.count,v.start+v.count-p.start):(++h,d[h]=v)}d.length=h+1;for(let f=0,p=d.length;f<p;f++){let v=d[f];i.bufferSubData(c,v.start*u.BYTES_PER_ELEMENT,u,v.start,v.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=t.get(a);l&&(i.deleteBuffer(l.buffer),t.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let u=t.get(a);(!u||u.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=t.get(a);if(c===void 0)t.set(a,e(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var Nv=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,Uv=`#ifdef USE_ALPHAHASH
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
#endif`,Fv=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,Ov=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,kv=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,Bv=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,zv=`#ifdef USE_AOMAP
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
#endif`,Hv=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,Gv=`#ifdef USE_BATCHING
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
#endif`,Vv=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,Wv=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,Xv=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,$v=`float G_BlinnPhong_Implicit( ) {
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
} // validated`,qv=`#ifdef USE_IRIDESCENCE
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
#endif`,Yv=`#ifdef USE_BUMPMAP
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
#endif`,Zv=`#if NUM_CLIPPING_PLANES > 0
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
#endif`,Kv=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,Jv=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,jv=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,Qv=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,tb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,eb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,nb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
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
#endif`,ib=`#define PI 3.141592653589793
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
} // validated`,sb=`vec3 transformedNormal = objectNormal;
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
#endif`,rb=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,ob=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,ab=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,lb=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,cb="gl_FragColor = linearToOutputTexel( gl_FragColor );",hb=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,ub=`#ifdef USE_ENVMAP
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
#endif`,db=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,fb=`#ifdef USE_ENVMAP
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
#endif`,pb=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,mb=`#ifdef USE_ENVMAP
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
#endif`,gb=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,_b=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,yb=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,xb=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,vb=`#ifdef USE_GRADIENTMAP
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
}`,bb=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Sb=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Mb=`varying vec3 vViewPosition;
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
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,wb=`uniform bool receiveShadow;
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
#include <lightprobes_pars_fragment>`,Eb=`#ifdef USE_ENVMAP
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
#endif`,Tb=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,Ab=`varying vec3 vViewPosition;
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
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,Rb=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,Cb=`varying vec3 vViewPosition;
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
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,Pb=`PhysicalMaterial material;
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
#endif`,Ib=`uniform sampler2D dfgLUT;
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
}`,Lb=`
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
#endif`,Db=`#if defined( RE_IndirectDiffuse )
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
#endif`,Nb=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,Ub=`#if NUM_LIGHT_PROBE_GRIDS > 0
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
#endif`,Fb=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,Ob=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,kb=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Bb=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,zb=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,Hb=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,Gb=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
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
#endif`,Vb=`#if defined( USE_POINTS_UV )
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
#endif`,Wb=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,Xb=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,$b=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,qb=`#if defined( USE_MORPHCOLORS )
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
#endif`,Yb=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,Zb=`#ifdef USE_MORPHTARGETS
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
#endif`,Kb=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,Jb=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
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
vec3 nonPerturbedNormal = normal;`,jb=`#ifdef USE_NORMALMAP_OBJECTSPACE
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
#endif`,Qb=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,tS=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,eS=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,nS=`#ifdef USE_NORMALMAP
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
#endif`,iS=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,sS=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,rS=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,oS=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,aS=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,lS=`vec3 packNormalToRGB( const in vec3 normal ) {
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
}`,cS=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,hS=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,uS=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,dS=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,fS=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,pS=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,mS=`#if NUM_SPOT_LIGHT_COORDS > 0
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
#endif`,gS=`#if NUM_SPOT_LIGHT_COORDS > 0
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
#endif`,_S=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
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
#endif`,yS=`float getShadowMask() {
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
}`,xS=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,vS=`#ifdef USE_SKINNING
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
#endif`,bS=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,SS=`#ifdef USE_SKINNING
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
#endif`,MS=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,wS=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,ES=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,TS=`#ifndef saturate
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
vec3 CustomToneMapping( vec3 color ) { return color; }`,AS=`#ifdef USE_TRANSMISSION
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
#endif`,RS=`#ifdef USE_TRANSMISSION
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
#endif`,CS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
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
#endif`,PS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
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
#endif`,IS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
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
#endif`,LS=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,DS=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,NS=`uniform sampler2D t2D;
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
}`,US=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,FS=`uniform float backgroundBlurriness;
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
}`,OS=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,kS=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,BS=`#include <common>
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
}`,zS=`#if DEPTH_PACKING == 3200
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
}`,HS=`#define DISTANCE
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
}`,GS=`#define DISTANCE
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
}`,VS=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,WS=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,XS=`uniform float scale;
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
}`,$S=`uniform vec3 diffuse;
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
}`,qS=`#include <common>
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
}`,YS=`uniform vec3 diffuse;
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
}`,ZS=`#define LAMBERT
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
}`,KS=`#define LAMBERT
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
}`,JS=`#define MATCAP
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
}`,jS=`#define MATCAP
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
}`,QS=`#define NORMAL
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
}`,tM=`#define NORMAL
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
}`,eM=`#define PHONG
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
}`,nM=`#define PHONG
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
}`,iM=`#define STANDARD
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
}`,sM=`#define STANDARD
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
}`,rM=`#define TOON
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
}`,oM=`#define TOON
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
}`,aM=`uniform float size;
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
}`,lM=`uniform vec3 diffuse;
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
}`,cM=`#include <common>
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
}`,hM=`uniform vec3 color;
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
}`,uM=`uniform float rotation;
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
}`,dM=`uniform vec3 diffuse;
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
}`,he={alphahash_fragment:Nv,alphahash_pars_fragment:Uv,alphamap_fragment:Fv,alphamap_pars_fragment:Ov,alphatest_fragment:kv,alphatest_pars_fragment:Bv,aomap_fragment:zv,aomap_pars_fragment:Hv,batching_pars_vertex:Gv,batching_vertex:Vv,begin_vertex:Wv,beginnormal_vertex:Xv,bsdfs:$v,iridescence_fragment:qv,bumpmap_pars_fragment:Yv,clipping_planes_fragment:Zv,clipping_planes_pars_fragment:Kv,clipping_planes_pars_vertex:Jv,clipping_planes_vertex:jv,color_fragment:Qv,color_pars_fragment:tb,color_pars_vertex:eb,color_vertex:nb,common:ib,defaultnormal_vertex:sb,displacementmap_pars_vertex:rb,displacementmap_vertex:ob,emissivemap_fragment:ab,emissivemap_pars_fragment:lb,colorspace_fragment:cb,colorspace_pars_fragment:hb,envmap_fragment:ub,envmap_common_pars_fragment:db,envmap_pars_fragment:fb,envmap_pars_vertex:pb,envmap_physical_pars_fragment:Eb,envmap_vertex:mb,fog_vertex:gb,fog_pars_vertex:_b,fog_fragment:yb,fog_pars_fragment:xb,gradientmap_pars_fragment:vb,lightmap_pars_fragment:bb,lights_lambert_fragment:Sb,lights_lambert_pars_fragment:Mb,lights_pars_begin:wb,lights_toon_fragment:Tb,lights_toon_pars_fragment:Ab,lights_phong_fragment:Rb,lights_phong_pars_fragment:Cb,lights_physical_fragment:Pb,lights_physical_pars_fragment:Ib,lights_fragment_begin:Lb,lights_fragment_maps:Db,lights_fragment_end:Nb,lightprobes_pars_fragment:Ub,logdepthbuf_fragment:Fb,logdepthbuf_pars_fragment:Ob,logdepthbuf_pars_vertex:kb,logdepthbuf_vertex:Bb,map_fragment:zb,map_pars_fragment:Hb,map_particle_fragment:Gb,map_particle_pars_fragment:Vb,metalnessmap_fragment:Wb,metalnessmap_pars_fragment:Xb,morphinstance_vertex:$b,morphcolor_vertex:qb,morphnormal_vertex:Yb,morphtarget_pars_vertex:Zb,morphtarget_vertex:Kb,normal_fragment_begin:Jb,normal_fragment_maps:jb,normal_pars_fragment:Qb,normal_pars_vertex:tS,normal_vertex:eS,normalmap_pars_fragment:nS,clearcoat_normal_fragment_begin:iS,clearcoat_normal_fragment_maps:sS,clearcoat_pars_fragment:rS,iridescence_pars_fragment:oS,opaque_fragment:aS,packing:lS,premultiplied_alpha_fragment:cS,project_vertex:hS,dithering_fragment:uS,dithering_pars_fragment:dS,roughnessmap_fragment:fS,roughnessmap_pars_fragment:pS,shadowmap_pars_fragment:mS,shadowmap_pars_vertex:gS,shadowmap_vertex:_S,shadowmask_pars_fragment:yS,skinbase_vertex:xS,skinning_pars_vertex:vS,skinning_vertex:bS,skinnormal_vertex:SS,specularmap_fragment:MS,specularmap_pars_fragment:wS,tonemapping_fragment:ES,tonemapping_pars_fragment:TS,transmission_fragment:AS,transmission_pars_fragment:RS,uv_pars_fragment:CS,uv_pars_vertex:PS,uv_vertex:IS,worldpos_vertex:LS,background_vert:DS,background_frag:NS,backgroundCube_vert:US,backgroundCube_frag:FS,cube_vert:OS,cube_frag:kS,depth_vert:BS,depth_frag:zS,distance_vert:HS,distance_frag:GS,equirect_vert:VS,equirect_frag:WS,linedashed_vert:XS,linedashed_frag:$S,meshbasic_vert:qS,meshbasic_frag:YS,meshlambert_vert:ZS,meshlambert_frag:KS,meshmatcap_vert:JS,meshmatcap_frag:jS,meshnormal_vert:QS,meshnormal_frag:tM,meshphong_vert:eM,meshphong_frag:nM,meshphysical_vert:iM,meshphysical_frag:sM,meshtoon_vert:rM,meshtoon_frag:oM,points_vert:aM,points_frag:lM,shadow_vert:cM,shadow_frag:hM,sprite_vert:uM,sprite_frag:dM},Dt={common:{diffuse:{value:new Zt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new ne},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new ne}},envmap:{envMap:{value:null},envMapRotation:{value:new ne},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new ne}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new ne}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new ne},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new ne},normalScale:{value:new Vt(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new ne},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new ne}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new ne}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new ne}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Zt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Zt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0},uvTransform:{value:new ne}},sprite:{diffuse:{value:new Zt(16777215)},opacity:{value:1},center:{value:new Vt(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new ne},alphaMap:{value:null},alphaMapTransform:{value:new ne},alphaTest:{value:0}}},es={basic:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.fog]),vertexShader:he.meshbasic_vert,fragmentShader:he.meshbasic_frag},lambert:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},envMapIntensity:{value:1}}]),vertexShader:he.meshlambert_vert,fragmentShader:he.meshlambert_frag},phong:{uniforms:qn([Dt.common,Dt.specularmap,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},specular:{value:new Zt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:he.meshphong_vert,fragmentShader:he.meshphong_frag},standard:{uniforms:qn([Dt.common,Dt.envmap,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.roughnessmap,Dt.metalnessmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:he.meshphysical_vert,fragmentShader:he.meshphysical_frag},toon:{uniforms:qn([Dt.common,Dt.aomap,Dt.lightmap,Dt.emissivemap,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.gradientmap,Dt.fog,Dt.lights,{emissive:{value:new Zt(0)}}]),vertexShader:he.meshtoon_vert,fragmentShader:he.meshtoon_frag},matcap:{uniforms:qn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,Dt.fog,{matcap:{value:null}}]),vertexShader:he.meshmatcap_vert,fragmentShader:he.meshmatcap_frag},points:{uniforms:qn([Dt.points,Dt.fog]),vertexShader:he.points_vert,fragmentShader:he.points_frag},dashed:{uniforms:qn([Dt.common,Dt.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:he.linedashed_vert,fragmentShader:he.linedashed_frag},depth:{uniforms:qn([Dt.common,Dt.displacementmap]),vertexShader:he.depth_vert,fragmentShader:he.depth_frag},normal:{uniforms:qn([Dt.common,Dt.bumpmap,Dt.normalmap,Dt.displacementmap,{opacity:{value:1}}]),vertexShader:he.meshnormal_vert,fragmentShader:he.meshnormal_frag},sprite:{uniforms:qn([Dt.sprite,Dt.fog]),vertexShader:he.sprite_vert,fragmentShader:he.sprite_frag},background:{uniforms:{uvTransform:{value:new ne},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:he.background_vert,fragmentShader:he.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new ne}},vertexShader:he.backgroundCube_vert,fragmentShader:he.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:he.cube_vert,fragmentShader:he.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:he.equirect_vert,fragmentShader:he.equirect_frag},distance:{uniforms:qn([Dt.common,Dt.displacementmap,{referencePosition:{value:new H},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:he.distance_vert,fragmentShader:he.distance_frag},shadow:{uniforms:qn([Dt.lights,Dt.fog,{color:{value:new Zt(0)},opacity:{value:1}}]),vertexShader:he.shadow_vert,fragmentShader:he.shadow_frag}};es.physical={uniforms:qn([es.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new ne},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new ne},clearcoatNormalScale:{value:new Vt(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new ne},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new ne},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new ne},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new ne},sheen:{value:0},sheenColor:{value:new Zt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new ne},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new ne},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new ne},transmissionSamplerSize:{value:new Vt},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new ne},attenuationDistance:{value:0},attenuationColor:{value:new Zt(0)},specularColor:{value:new Zt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new ne},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new ne},anisotropyVector:{value:new Vt},anisotropyMap:{value:null},anisotropyMapTransform:{value:new ne}}]),vertexShader:he.meshphysical_vert,fragmentShader:he.meshphysical_frag};var ph={r:0,b:0,g:0},fM=new Oe,Jg=new ne;Jg.set(-1,0,0,0,1,0,0,0,1);function pM(i,t,e,n,s,r){let o=new Zt(0),a=s===!0?0:1,l,c,u=null,d=0,h=null;function f(S){let M=S.isScene===!0?S.background:null;if(M&&M.isTexture){let y=S.backgroundBlurriness>0;M=t.get(M,y)}return M}function p(S){let M=!1,y=f(S);y===null?m(o,a):y&&y.isColor&&(m(y,1),M=!0);let C=i.xr.getEnvironmentBlendMode();C==="additive"?e.buffers.color.setClear(0,0,0,1,r):C==="alpha-blend"&&e.buffers.color.setClear(0,0,0,0,r),(i.autoClear||M)&&(e.buffers.depth.setTest(!0),e.buffers.depth.setMask(!0),e.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function v(S,M){let y=f(M);y&&y.isCubeTexture?(c===void 0&&(c=new ke(new Vs(1,1,1),new Ti({name:"BackgroundCubeMaterial",uniforms:br(es.backgroundCube.uniforms),vertexShader:es.backgroundCube.vertexShader,fragmentShader:es.backgroundCube.fragmentShader,side:ii,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(C,A,x){this.matrixWorld.copyPosition(x.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=y,c.material.uniforms.backgroundBlurriness.value=M.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=M.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(fM.makeRotationFromEuler(M.backgroundRotation)).transpose(),y.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(Jg),c.material.toneMapped=_e.getTransfer(y.colorSpace)!==Ae,(u!==y||d!==y.version||h!==i.toneMapping)&&(c.material.needsUpdate=!0,u=y,d=y.version,h=i.toneMapping),c.layers.enableAll(),S.unshift(c,c.geometry,c.material,0,0,null)):y&&y.isTexture&&(l===void 0&&(l=new ke(new pr(2,2),new Ti({name:"BackgroundMaterial",uniforms:br(es.background.uniforms),vertexShader:es.background.vertexShader,fragmentShader:es.background.fragmentShader,side:Qs,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=y,l.material.uniforms.backgroundIntensity.value=M.backgroundIntensity,l.material.toneMapped=_e.getTransfer(y.colorSpace)!==Ae,y.matrixAutoUpdate===!0&&y.updateMatrix(),l.material.uniforms.uvTransform.value.copy(y.matrix),(u!==y||d!==y.version||h!==i.toneMapping)&&(l.material.needsUpdate=!0,u=y,d=y.version,h=i.toneMapping),l.layers.enableAll(),S.unshift(l,l.geometry,l.material,0,0,null))}function m(S,M){S.getRGB(ph,Vd(i)),e.buffers.color.setClear(ph.r,ph.g,ph.b,M,r)}function g(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(S,M=1){o.set(S),a=M,m(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(S){a=S,m(o,a)},render:p,addToRenderList:v,dispose:g}}function mM(i,t){let e=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=h(null),r=s,o=!1;function a(D,B,G,N,W){let q=!1,V=d(D,N,G,B);r!==V&&(r=V,c(r.object)),q=f(D,N,G,W),q&&p(D,N,G,W),W!==null&&t.update(W,i.ELEMENT_ARRAY_BUFFER),(q||o)&&(o=!1,y(D,B,G,N),W!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,t.get(W).buffer))}function l(){return i.createVertexArray()}function c(D){return i.bindVertexArray(D)}function u(D){return i.deleteVertexArray(D)}function d(D,B,G,N){let W=N.wireframe===!0,q=n[B.id];q===void 0&&(q={},n[B.id]=q);let V=D.isInstancedMesh===!0?D.id:0,lt=q[V];lt===void 0&&(lt={},q[V]=lt);let Z=lt[G.id];Z===void 0&&(Z={},lt[G.id]=Z);let j=Z[W];return j===void 0&&(j=h(l()),Z[W]=j),j}function h(D){let B=[],G=[],N=[];for(let W=0;W<e;W++)B[W]=0,G[W]=0,N[W]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:B,enabledAttributes:G,attributeDivisors:N,object:D,attributes:{},index:null}}function f(D,B,G,N){let W=r.attributes,q=B.attributes,V=0,lt=G.getAttributes();for(let Z in lt)if(lt[Z].location>=0){let et=W[Z],dt=q[Z];if(dt===void 0&&(Z==="instanceMatrix"&&D.instanceMatrix&&(dt=D.instanceMatrix),Z==="instanceColor"&&D.instanceColor&&(dt=D.instanceColor)),et===void 0||et.attribute!==dt||dt&&et.data!==dt.data)return!0;V++}return r.attributesNum!==V||r.index!==N}function p(D,B,G,N){let W={},q=B.attributes,V=0,lt=G.getAttributes();for(let Z in lt)if(lt[Z].location>=0){let et=q[Z];et===void 0&&(Z==="instanceMatrix"&&D.instanceMatrix&&(et=D.instanceMatrix),Z==="instanceColor"&&D.instanceColor&&(et=D.instanceColor));let dt={};dt.attribute=et,et&&et.data&&(dt.data=et.data),W[Z]=dt,V++}r.attributes=W,r.attributesNum=V,r.index=N}function v(){let D=r.newAttributes;for(let B=0,G=D.length;B<G;B++)D[B]=0}function m(D){g(D,0)}function g(D,B){let G=r.newAttributes,N=r.enabledAttributes,W=r.attributeDivisors;G[D]=1,N[D]===0&&(i.enableVertexAttribArray(D),N[D]=1),W[D]!==B&&(i.vertexAttribDivisor(D,B),W[D]=B)}function S(){let D=r.newAttributes,B=r.enabledAttributes;for(let G=0,N=B.length;G<N;G++)B[G]!==D[G]&&(i.disableVertexAttribArray(G),B[G]=0)}function M(D,B,G,N,W,q,V){V===!0?i.vertexAttribIPointer(D,B,G,W,q):i.vertexAttribPointer(D,B,G,N,W,q)}function y(D,B,G,N){v();let W=N.attributes,q=G.getAttributes(),V=B.defaultAttributeValues;for(let lt in q){let Z=q[lt];if(Z.location>=0){let j=W[lt];if(j===void 0&&(lt==="instanceMatrix"&&D.instanceMatrix&&(j=D.instanceMatrix),lt==="instanceColor"&&D.instanceColor&&(j=D.instanceColor)),j!==void 0){let et=j.normalized,dt=j.itemSize,ut=t.get(j);if(ut===void 0)continue;let tt=ut.buffer,mt=ut.type,yt=ut.bytesPerElement,At=mt===i.INT||mt===i.UNSIGNED_INT||j.gpuType===Lc;if(j.isInterleavedBufferAttribute){let St=j.data,Xt=St.isInterleavedBuffer===!0?St.stride:St.itemSize,re=j.offset;if(St.isInstancedInterleavedBuffer||St.isInstancedBufferAttribute){for(let Gt=0;Gt<Z.locationSize;Gt++)g(Z.location+Gt,St.meshPerAttribute);D.isInstancedMesh!==!0&&N._maxInstanceCount===void 0&&(N._maxInstanceCount=St.meshPerAttribute*St.count)}else for(let Gt=0;Gt<Z.locationSize;Gt++)m(Z.location+Gt);i.bindBuffer(i.ARRAY_BUFFER,tt);for(let Gt=0;Gt<Z.locationSize;Gt++)M(Z.location+Gt,dt/Z.locationSize,mt,et,Xt*yt,(re+dt/Z.locationSize*Gt)*yt,At)}else{if(j.isInstancedBufferAttribute){for(let St=0;St<Z.locationSize;St++)g(Z.location+St,j.meshPerAttribute);D.isInstancedMesh!==!0&&N._maxInstanceCount===void 0&&(N._maxInstanceCount=j.meshPerAttribute*j.count)}else for(let St=0;St<Z.locationSize;St++)m(Z.location+St);i.bindBuffer(i.ARRAY_BUFFER,tt);for(let St=0;St<Z.locationSize;St++)M(Z.location+St,dt/Z.locationSize,mt,et,dt*yt,dt/Z.locationSize*St*yt,At)}}else if(V!==void 0){let et=V[lt];if(et!==void 0)switch(et.length){case 2:i.vertexAttrib2fv(Z.location,et);break;case 3:i.vertexAttrib3fv(Z.location,et);break;case 4:i.vertexAttrib4fv(Z.location,et);break;default:i.vertexAttrib1fv(Z.location,et)}}}}S()}function C(){F();for(let D in n){let B=n[D];for(let G in B){let N=B[G];for(let W in N){let q=N[W];for(let V in q)u(q[V].object),delete q[V];delete N[W]}}delete n[D]}}function A(D){if(n[D.id]===void 0)return;let B=n[D.id];for(let G in B){let N=B[G];for(let W in N){let q=N[W];for(let V in q)u(q[V].object),delete q[V];delete N[W]}}delete n[D.id]}function x(D){for(let B in n){let G=n[B];for(let N in G){let W=G[N];if(W[D.id]===void 0)continue;let q=W[D.id];for(let V in q)u(q[V].object),delete q[V];delete W[D.id]}}}function E(D){for(let B in n){let G=n[B],N=D.isInstancedMesh===!0?D.id:0,W=G[N];if(W!==void 0){for(let q in W){let V=W[q];for(let lt in V)u(V[lt].object),delete V[lt];delete W[q]}delete G[N],Object.keys(G).length===0&&delete n[B]}}}function F(){L(),o=!0,r!==s&&(r=s,c(r.object))}function L(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:F,resetDefaultState:L,dispose:C,releaseStatesOfGeometry:A,releaseStatesOfObject:E,releaseStatesOfProgram:x,initAttributes:v,enableAttribute:m,disableUnusedAttributes:S}}function gM(i,t,e){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),e.update(c,n,1)}function o(l,c,u){u!==0&&(i.drawArraysInstanced(n,l,c,u),e.update(c,n,u))}function a(l,c,u){if(u===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,u);let h=0;for(let f=0;f<u;f++)h+=c[f];e.update(h,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function _M(i,t,e,n){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let x=t.get("EXT_texture_filter_anisotropic");s=i.getParameter(x.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(x){return!(x!==si&&n.convert(x)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(x){let E=x===Bi&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(x!==ai&&x!==li&&!E&&n.convert(x)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(x){if(x==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";x="mediump"}return x==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=e.precision!==void 0?e.precision:"highp",u=l(c);u!==c&&(Yt("WebGLRenderer:",c,"not supported, using",u,"instead."),c=u);let d=e.reversedDepthBuffer===!0&&t.has("EXT_clip_control"),h=e.logarithmicDepthBuffer===!0&&d===!1;e.reversedDepthBuffer===!0&&d===!1&&Yt("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),e.logarithmicDepthBuffer===!0&&d===!0&&Yt("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let f=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),p=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),v=i.getParameter(i.MAX_TEXTURE_SIZE),m=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),g=i.getParameter(i.MAX_VERTEX_ATTRIBS),S=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),M=i.getParameter(i.MAX_VARYING_VECTORS),y=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),C=i.getParameter(i.MAX_SAMPLES),A=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:h,reversedDepthBuffer:d,maxTextures:f,maxVertexTextures:p,maxTextureSize:v,maxCubemapSize:m,maxAttributes:g,maxVertexUniforms:S,maxVaryings:M,maxFragmentUniforms:y,maxSamples:C,samples:A}}function yM(i){let t=this,e=null,n=0,s=!1,r=!1,o=new zn,a=new ne,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(d,h){let f=d.length!==0||h||n!==0||s;return s=h,n=d.length,f},this.beginShadows=function(){r=!0,u(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(d,h){e=u(d,h,0)},this.setState=function(d,h,f){let p=d.clippingPlanes,v=d.clipIntersection,m=d.clipShadows,g=i.get(d);if(!s||p===null||p.length===0||r&&!m)r?u(null):c();else{let S=r?0:n,M=S*4,y=g.clippingState||null;l.value=y,y=u(p,h,M,f);for(let C=0;C!==M;++C)y[C]=e[C];g.clippingState=y,this.numIntersection=v?this.numPlanes:0,this.numPlanes+=S}};function c(){l.value!==e&&(l.value=e,l.needsUpdate=n>0),t.numPlanes=n,t.numIntersection=0}function u(d,h,f,p){let v=d!==null?d.length:0,m=null;if(v!==0){if(m=l.value,p!==!0||m===null){let g=f+v*4,S=h.matrixWorldInverse;a.getNormalMatrix(S),(m===null||m.length<g)&&(m=new Float32Array(g));for(let M=0,y=f;M!==v;++M,y+=4)o.copy(d[M]).applyMatrix4(S,a),o.normal.toArray(m,y),m[y+3]=o.constant}l.value=m,l.needsUpdate=!0}return t.numPlanes=v,t.numIntersection=0,m}}var Va=class extends gi{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let n={width:t,height:t,depth:1},s=[n,n,n,n,n,n];this.texture=new ga(s),this._setTextureOptions(e),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

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
			`},s=new Vs(5,5,5),r=new Ti({name:"CubemapFromEquirect",uniforms:br(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:ii,blending:_r});r.uniforms.tEquirect.value=e;let o=new ke(s,r),a=e.minFilter;return e.minFilter===xs&&(e.minFilter=ei),new yo(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e=!0,n=!0,s=!0){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,n,s);t.setRenderTarget(r)}},Cg=256,xM=3,vM=20,jg=256,Qg=16,bM=3,SM=new H,MM=new Zt,gh=class i{constructor(t){this._renderer=t,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new yo(1,10,null),this._boxMesh=new ke(new Vs(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(t,e=0,n=.1,s=100,r={}){let{size:o=256,position:a=SM}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),u=this._getSourceTarget(!0);e>0&&(u.texture.mipmapsAutoUpdate=!1);let d=l.autoClear,h=l.autoClearColor,f=l.autoClearDepth,p=l.autoClearStencil,v=t.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,v===null&&(t.background=l.getClearColor(MM));let m=new yo(n,s,u);return m.position.copy(a),m.update(l,t),l.autoClear=d,l.autoClearColor=h,l.autoClearDepth=f,l.autoClearStencil=p,t.background=v,e>0&&(u.texture.mipmapsAutoUpdate=!0,this._blur(c,e)),this._applyPMREM(c),c}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=Lg(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=Ig(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(t,e){return e>0?1-Math.sqrt(1-t/e):0}_setSize(t){this._cubeSize=Math.max(Cg,Hd(t))}_fromTexture(t,e){t.mapping===xr||t.mapping===bo?this._setSize(t.image.length===0?Cg:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4);let n=e||this._allocateTarget();return this._textureToCubemap(t),this._applyPMREM(n),n}_allocateTarget(){let t=this._cubeSize,e=Pg(t,!1,!1),n=Math.log2(t)-xM;for(let s=0;s<=n;s++)e.texture.mipmaps.push({width:t>>s,height:t>>s});return e.texture.name="PMREM",e.texture.isPMREMTexture=!0,e}_getSourceTarget(t=!1){let e=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==e||t&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=Pg(e,!0,t)),this._sourceTarget}_compileMaterial(t){this._boxMesh.material=t,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(t,e,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=t,r.activeMipmapLevel=e;let o=t.width>>e;t.viewport.set(0,0,o,o),r.update(this._renderer,s),t.viewport.set(0,0,t.width,t.height)}_textureToCubemap(t){let e;t.mapping===xr||t.mapping===bo?(this._cubemapMaterial===null&&(this._cubemapMaterial=Lg()),e=this._cubemapMaterial,e.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=Ig()),e=this._equirectMaterial),e.uniforms.envMap.value=t,this._renderCube(this._getSourceTarget(),0,e)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=wM(),this._integrationMaterial=EM());let e=this._cubeSize,n=t.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(e/Qg);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-bM)r.roughness.value=a,this._renderCube(t,o,this._integrationMaterial);else{let l=a>0?Math.log2(e)+.5*Math.log2(6/(jg*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(t,o,this._ggxMaterial)}}}_blur(t,e){this._blurMaterial===null&&(this._blurMaterial=TM());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(e,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(t,0,n),s.envMap.value=t.texture,this._renderCube(r,0,n)}};function Pg(i,t,e){return new Va(i,{minFilter:xs,generateMipmaps:t,type:Bi,colorSpace:oa,depthBuffer:e})}function Wa(i,t,e){return new Ti({name:i,uniforms:t,vertexShader:he.cube_vert,fragmentShader:e,side:ii,blending:_r,depthTest:!1,depthWrite:!1})}function wM(){return Wa("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${jg}u

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
	`)}function EM(){return Wa("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Qg}},`

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
	`)}function TM(){return Wa("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${vM}
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
	`)}function Ig(){return Wa("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

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
	`)}function Lg(){return Wa("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function AM(i){let t=new WeakMap,e=new WeakMap,n=null;function s(h,f=!1){return h==null?null:f?o(h):r(h)}function r(h){if(h&&h.isTexture){let f=h.mapping;if(f===Cc||f===Pc)if(t.has(h)){let p=t.get(h).texture;return a(p,h.mapping)}else{let p=h.image;if(p&&p.height>0){let v=new Va(p.height);return v.fromEquirectangularTexture(i,h),t.set(h,v),h.addEventListener("dispose",c),a(v.texture,h.mapping)}else return null}}return h}function o(h){if(h&&h.isTexture&&h.isPMREMTexture!==!0){let f=h.mapping,p=f===Cc||f===Pc,v=f===xr||f===bo;if(p||v){let m=e.get(h),g=m!==void 0?m.texture.pmremVersion:0;if(h.isRenderTargetTexture&&h.pmremVersion!==g)return n===null&&(n=new gh(i)),m=p?n.fromEquirectangular(h,m):n.fromCubemap(h,m),m.texture.pmremVersion=h.pmremVersion,e.set(h,m),m.texture;if(m!==void 0)return m.texture;{let S=h.image;return p&&S&&S.height>0||v&&S&&l(S)?(n===null&&(n=new gh(i)),m=p?n.fromEquirectangular(h):n.fromCubemap(h),m.texture.pmremVersion=h.pmremVersion,e.set(h,m),h.addEventListener("dispose",u),m.texture):null}}}return h}function a(h,f){return f===Cc?h.mapping=xr:f===Pc&&(h.mapping=bo),h}function l(h){let f=0,p=6;for(let v=0;v<p;v++)h[v]!==void 0&&f++;return f===p}function c(h){let f=h.target;f.removeEventListener("dispose",c);let p=t.get(f);p!==void 0&&(t.delete(f),p.dispose())}function u(h){let f=h.target;f.removeEventListener("dispose",u);let p=e.get(f);p!==void 0&&(e.delete(f),p.dispose())}function d(){t=new WeakMap,e=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:d}}function RM(i){let t={};function e(n){if(t[n]!==void 0)return t[n];let s=i.getExtension(n);return t[n]=s,s}return{has:function(n){return e(n)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(n){let s=e(n);return s===null&&na("WebGLRenderer: "+n+" extension not supported."),s}}}function CM(i,t,e,n){let s={},r=new WeakMap,o=new FinalizationRegistry(p=>delete s[p]);function a(p){l(p.target)}function l(p){p.index!==null&&t.remove(p.index);for(let m in p.attributes)t.remove(p.attributes[m]);p.removeEventListener("dispose",a),delete s[p.id],o.unregister(p);let v=r.get(p);v&&(t.remove(v),r.delete(p)),n.releaseStatesOfGeometry(p),p.isInstancedBufferGeometry===!0&&delete p._maxInstanceCount,e.memory.geometries--}function c(p,v){return s[v.id]!==void 0||(v.addEventListener("dispose",a),s[v.id]=new WeakRef(v),o.register(v,v.id,v),e.memory.geometries++),v}function u(p){let v=p.attributes;for(let m in v)t.update(v[m],i.ARRAY_BUFFER)}function d(p){let v=p.index,m=p.attributes.position,g=0;if(m===void 0)return;let S=v!==null?v.array.length:m.array.length/3-1,M=m.count>=65535?fa:da,y=new M(Math.ceil(S/3)*6,1),C=y.array;if(v!==null){let x=v.array;g=v.version;for(let E=0,F=0;E<S;E+=3){let L=x[E+0],D=x[E+1],B=x[E+2];C[F++]=L,C[F++]=D,C[F++]=D,C[F++]=B,C[F++]=B,C[F++]=L}}else{g=m.version;for(let x=0,E=0;x<S;x+=3){let F=x+0,L=x+1,D=x+2;C[E++]=F,C[E++]=L,C[E++]=L,C[E++]=D,C[E++]=D,C[E++]=F}}y.version=g;let A=r.get(p);A&&t.remove(A),r.set(p,y)}function h(p){let v=r.get(p);if(v){let m=p.index;m!==null&&v.version<m.version&&d(p)}else d(p);return r.get(p)}function f(){for(let p in s){let v=s[p].deref();v!==void 0&&l(v)}}return{get:c,update:u,getWireframeAttribute:h,dispose:f}}function PM(i,t,e){let n;function s(d){n=d}let r,o;function a(d){r=d.type,o=d.bytesPerElement}function l(d,h){i.drawElements(n,h,r,d*o),e.update(h,n,1)}function c(d,h,f){f!==0&&(i.drawElementsInstanced(n,h,r,d*o,f),e.update(h,n,f))}function u(d,h,f){if(f===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,h,0,r,d,0,f);let v=0;for(let m=0;m<f;m++)v+=h[m];e.update(v,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=u}function IM(i){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(e.calls++,o){case i.TRIANGLES:e.triangles+=a*(r/3);break;case i.LINES:e.lines+=a*(r/2);break;case i.LINE_STRIP:e.lines+=a*(r-1);break;case i.LINE_LOOP:e.lines+=a*r;break;case i.POINTS:e.points+=a*r;break;default:te("WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:n}}function LM(i,t,e){let n=new WeakMap,s=new je;function r(o,a,l){let c=o.morphTargetInfluences,u=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,d=u!==void 0?u.length:0,h=n.get(a);if(h===void 0||h.count!==d){let F=function(){x.dispose(),n.delete(a),a.removeEventListener("dispose",F)};h!==void 0&&h.texture.dispose();let f=a.morphAttributes.position!==void 0,p=a.morphAttributes.normal!==void 0,v=a.morphAttributes.color!==void 0,m=a.morphAttributes.position||[],g=a.morphAttributes.normal||[],S=a.morphAttributes.color||[],M=0;f===!0&&(M=1),p===!0&&(M=2),v===!0&&(M=3);let y=a.attributes.position.count*M,C=1;y>t.maxTextureSize&&(C=Math.ceil(y/t.maxTextureSize),y=t.maxTextureSize);let A=new Float32Array(y*C*4*d),x=new ca(A,y,C,d);x.type=li,x.needsUpdate=!0;let E=M*4;for(let L=0;L<d;L++){let D=m[L],B=g[L],G=S[L],N=y*C*4*L;for(let W=0;W<D.count;W++){let q=W*E;f===!0&&(s.fromBufferAttribute(D,W),A[N+q+0]=s.x,A[N+q+1]=s.y,A[N+q+2]=s.z,A[N+q+3]=0),p===!0&&(s.fromBufferAttribute(B,W),A[N+q+4]=s.x,A[N+q+5]=s.y,A[N+q+6]=s.z,A[N+q+7]=0),v===!0&&(s.fromBufferAttribute(G,W),A[N+q+8]=s.x,A[N+q+9]=s.y,A[N+q+10]=s.z,A[N+q+11]=G.itemSize===4?s.w:1)}}h={count:d,texture:x,size:new Vt(y,C)},n.set(a,h),a.addEventListener("dispose",F)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,e);else{let f=0;for(let v=0;v<c.length;v++)f+=c[v];let p=a.morphTargetsRelative?1:1-f;l.getUniforms().setValue(i,"morphTargetBaseInfluence",p),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",h.texture,e),l.getUniforms().setValue(i,"morphTargetsTextureSize",h.size)}return{update:r}}function DM(i,t,e,n,s){let r=new WeakMap;function o(c){let u=s.render.frame,d=c.geometry,h=t.get(c,d);if(r.get(h)!==u&&(t.update(h),r.set(h,u)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==u&&(e.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&e.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,u))),c.isSkinnedMesh){let f=c.skeleton;r.get(f)!==u&&(f.update(),r.set(f,u))}return h}function a(){r=new WeakMap}function l(c){let u=c.target;u.removeEventListener("dispose",l),n.releaseStatesOfObject(u),e.remove(u.instanceMatrix),u.instanceColor!==null&&e.remove(u.instanceColor)}return{update:o,dispose:a}}var NM={[vd]:"LINEAR_TONE_MAPPING",[bd]:"REINHARD_TONE_MAPPING",[Sd]:"CINEON_TONE_MAPPING",[Md]:"ACES_FILMIC_TONE_MAPPING",[Ed]:"AGX_TONE_MAPPING",[Td]:"NEUTRAL_TONE_MAPPING",[wd]:"CUSTOM_TONE_MAPPING"};function UM(i,t,e,n,s,r){let o=new gi(t,e,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,u=new Ve;u.setAttribute("position",new Re([-1,3,0,-1,-1,0,3,-1,0],3)),u.setAttribute("uv",new Re([0,2,0,0,2,0],2));let d=new pc({uniforms:{tDiffuse:{value:null}},vertexShader:`
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
			}`,depthTest:!1,depthWrite:!1}),h=new ke(u,d),f=new Ra(-1,1,1,-1,0,1),p=null,v=null,m=!1,g,S=null,M=[],y=!1;this.setSize=function(C,A){o.setSize(C,A),a!==null&&a.setSize(C,A),l!==null&&l.setSize(C,A);for(let x=0;x<M.length;x++){let E=M[x];E.setSize&&E.setSize(C,A)}},this.setEffects=function(C){M=C,y=M.length>0&&M[0].isRenderPass===!0;let A=o.width,x=o.height;M.length>0&&a===null&&(a=new gi(A,x,{type:Bi,depthBuffer:!1,stencilBuffer:!1}),l=new gi(A,x,{type:Bi,depthBuffer:!1,stencilBuffer:!1}));let E=s===!0&&M.some(F=>F.needsDepthTexture===!0);E!==(o.depthTexture!==null)&&(E===!0&&c===null&&(c=new ys(A,x),r===!0&&(c.format=vs,c.type=vr)),o.dispose(),o.depthTexture=E?c:null,o.resolveDepthBuffer=E,o.storeMultisampledDepthBuffer=E);for(let F=0;F<M.length;F++){let L=M[F];L.setSize&&L.setSize(A,x),E&&L.needsDepthTexture===!0&&L.setDepthTexture&&L.setDepthTexture(c)}},this.begin=function(C,A){if(m||C.toneMapping===Qi&&M.length===0)return!1;if(S=A,A!==null){let x=A.width,E=A.height;(o.width!==x||o.height!==E)&&this.setSize(x,E)}return y===!1&&C.setRenderTarget(o),g=C.toneMapping,C.toneMapping=Qi,!0},this.hasRenderPass=function(){return y},this.end=function(C,A){C.toneMapping=g,m=!0;let x=o,E=a;for(let F=0;F<M.length;F++){let L=M[F];L.enabled!==!1&&(L.render(C,E,x,A),L.needsSwap!==!1&&(x=E,E=E===a?l:a))}if(p!==C.outputColorSpace||v!==C.toneMapping){p=C.outputColorSpace,v=C.toneMapping,d.defines={},_e.getTransfer(p)===Ae&&(d.defines.SRGB_TRANSFER="");let F=NM[v];F&&(d.defines[F]=""),d.needsUpdate=!0}d.uniforms.tDiffuse.value=x.texture,C.setRenderTarget(S),C.render(h,f),S=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),u.dispose(),d.dispose()}}var t0=new oi,e0=new ys(1,1),n0=new _a(1),i0=new ca,s0=new lc,r0=new ga,Dg=[],Ng=[],Ug=new Float32Array(16),Fg=new Float32Array(9),Og=new Float32Array(4);function To(i,t,e){let n=i[0];if(n<=0||n>0)return i;let s=t*e,r=Dg[s];if(r===void 0&&(r=new Float32Array(s),Dg[s]=r),t!==0){n.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,i[o].toArray(r,a)}return r}function Mn(i,t){if(i.length!==t.length)return!1;for(let e=0,n=i.length;e<n;e++)if(i[e]!==t[e])return!1;return!0}function wn(i,t){for(let e=0,n=t.length;e<n;e++)i[e]=t[e]}function yh(i,t){let e=Ng[t];e===void 0&&(e=new Int32Array(t),Ng[t]=e);for(let n=0;n!==t;++n)e[n]=i.allocateTextureUnit();return e}function FM(i,t){let e=this.cache;e[0]!==t&&(i.uniform1f(this.addr,t),e[0]=t)}function OM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Mn(e,t))return;i.uniform2fv(this.addr,t),wn(e,t)}}function kM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(i.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(Mn(e,t))return;i.uniform3fv(this.addr,t),wn(e,t)}}function BM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Mn(e,t))return;i.uniform4fv(this.addr,t),wn(e,t)}}function zM(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Mn(e,t))return;i.uniformMatrix2fv(this.addr,!1,t),wn(e,t)}else{if(Mn(e,n))return;Og.set(n),i.uniformMatrix2fv(this.addr,!1,Og),wn(e,n)}}function HM(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Mn(e,t))return;i.uniformMatrix3fv(this.addr,!1,t),wn(e,t)}else{if(Mn(e,n))return;Fg.set(n),i.uniformMatrix3fv(this.addr,!1,Fg),wn(e,n)}}function GM(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Mn(e,t))return;i.uniformMatrix4fv(this.addr,!1,t),wn(e,t)}else{if(Mn(e,n))return;Ug.set(n),i.uniformMatrix4fv(this.addr,!1,Ug),wn(e,n)}}function VM(i,t){let e=this.cache;e[0]!==t&&(i.uniform1i(this.addr,t),e[0]=t)}function WM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Mn(e,t))return;i.uniform2iv(this.addr,t),wn(e,t)}}function XM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Mn(e,t))return;i.uniform3iv(this.addr,t),wn(e,t)}}function $M(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Mn(e,t))return;i.uniform4iv(this.addr,t),wn(e,t)}}function qM(i,t){let e=this.cache;e[0]!==t&&(i.uniform1ui(this.addr,t),e[0]=t)}function YM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Mn(e,t))return;i.uniform2uiv(this.addr,t),wn(e,t)}}function ZM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Mn(e,t))return;i.uniform3uiv(this.addr,t),wn(e,t)}}function KM(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Mn(e,t))return;i.uniform4uiv(this.addr,t),wn(e,t)}}function xh(i){return i.version===0&&(i.compareFunction=Od,i.needsUpdate=!0),i}function JM(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=xh(e0):r=t0,e.setTexture2D(t||r,s)}function jM(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture3D(t||s0,s)}function QM(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=xh(n0):r=r0,e.setTextureCube(t||r,s)}function tw(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture2DArray(t||i0,s)}function ew(i){switch(i){case 5126:return FM;case 35664:return OM;case 35665:return kM;case 35666:return BM;case 35674:return zM;case 35675:return HM;case 35676:return GM;case 5124:case 35670:return VM;case 35667:case 35671:return WM;case 35668:case 35672:return XM;case 35669:case 35673:return $M;case 5125:return qM;case 36294:return YM;case 36295:return ZM;case 36296:return KM;case 35678:case 36198:case 36298:case 36306:case 35682:return JM;case 35679:case 36299:case 36307:return jM;case 35680:case 36300:case 36308:case 36293:return QM;case 36289:case 36303:case 36311:case 36292:return tw}}function nw(i,t){i.uniform1fv(this.addr,t)}function iw(i,t){let e=To(t,this.size,2);i.uniform2fv(this.addr,e)}function sw(i,t){let e=To(t,this.size,3);i.uniform3fv(this.addr,e)}function rw(i,t){let e=To(t,this.size,4);i.uniform4fv(this.addr,e)}function ow(i,t){let e=To(t,this.size,4);i.uniformMatrix2fv(this.addr,!1,e)}function aw(i,t){let e=To(t,this.size,9);i.uniformMatrix3fv(this.addr,!1,e)}function lw(i,t){let e=To(t,this.size,16);i.uniformMatrix4fv(this.addr,!1,e)}function cw(i,t){i.uniform1iv(this.addr,t)}function hw(i,t){i.uniform2iv(this.addr,t)}function uw(i,t){i.uniform3iv(this.addr,t)}function dw(i,t){i.uniform4iv(this.addr,t)}function fw(i,t){i.uniform1uiv(this.addr,t)}function pw(i,t){i.uniform2uiv(this.addr,t)}function mw(i,t){i.uniform3uiv(this.addr,t)}function gw(i,t){i.uniform4uiv(this.addr,t)}function _w(i,t,e){let n=this.cache,s=t.length,r=yh(e,s);Mn(n,r)||(i.uniform1iv(this.addr,r),wn(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=xh(e0):o=t0;for(let a=0;a!==s;++a)e.setTexture2D(t[a]||o,r[a])}function yw(i,t,e){let n=this.cache,s=t.length,r=yh(e,s);Mn(n,r)||(i.uniform1iv(this.addr,r),wn(n,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||s0,r[o])}function xw(i,t,e){let n=this.cache,s=t.length,r=yh(e,s);Mn(n,r)||(i.uniform1iv(this.addr,r),wn(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=xh(n0):o=r0;for(let a=0;a!==s;++a)e.setTextureCube(t[a]||o,r[a])}function vw(i,t,e){let n=this.cache,s=t.length,r=yh(e,s);Mn(n,r)||(i.uniform1iv(this.addr,r),wn(n,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||i0,r[o])}function bw(i){switch(i){case 5126:return nw;case 35664:return iw;case 35665:return sw;case 35666:return rw;case 35674:return ow;case 35675:return aw;case 35676:return lw;case 5124:case 35670:return cw;case 35667:case 35671:return hw;case 35668:case 35672:return uw;case 35669:case 35673:return dw;case 5125:return fw;case 36294:return pw;case 36295:return mw;case 36296:return gw;case 35678:case 36198:case 36298:case 36306:case 35682:return _w;case 35679:case 36299:case 36307:return yw;case 35680:case 36300:case 36308:case 36293:return xw;case 36289:case 36303:case 36311:case 36292:return vw}}var Zd=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.setValue=ew(e.type)}},Kd=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=bw(e.type)}},Jd=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],n)}}},qd=/(\w+)(\])?(\[|\.)?/g;function kg(i,t){i.seq.push(t),i.map[t.id]=t}function Sw(i,t,e){let n=i.name,s=n.length;for(qd.lastIndex=0;;){let r=qd.exec(n),o=qd.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){kg(e,c===void 0?new Zd(a,i,t):new Kd(a,i,t));break}else{let d=e.map[a];d===void 0&&(d=new Jd(a),kg(e,d)),e=d}}}var Eo=class{constructor(t,e){this.seq=[],this.map={};let n=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=t.getActiveUniform(e,o),l=t.getUniformLocation(e,a.name);Sw(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===t.SAMPLER_2D_SHADOW||o.type===t.SAMPLER_CUBE_SHADOW||o.type===t.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(t,e,n,s){let r=this.map[e];r!==void 0&&r.setValue(t,n,s)}setOptional(t,e,n){let s=e[n];s!==void 0&&this.setValue(t,n,s)}static upload(t,e,n,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(t,l.value,s)}}static seqWithValue(t,e){let n=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&n.push(o)}return n}};function Bg(i,t,e){let n=i.createShader(t);return i.shaderSource(n,e),i.compileShader(n),n}var Mw=37297,ww=0;function Ew(i,t){let e=i.split(`
`),n=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return n.join(`
`)}var zg=new ne;function Tw(i){_e._getMatrix(zg,_e.workingColorSpace,i);let t=`mat3( ${zg.elements.map(e=>e.toFixed(4))} )`;switch(_e.getTransfer(i)){case aa:return[t,"LinearTransferOETF"];case Ae:return[t,"sRGBTransferOETF"];default:return Yt("WebGLProgram: Unsupported color space: ",i),[t,"LinearTransferOETF"]}}function Hg(i,t,e){let n=i.getShaderParameter(t,i.COMPILE_STATUS),r=(i.getShaderInfoLog(t)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return e.toUpperCase()+`

`+r+`

`+Ew(i.getShaderSource(t),a)}else return r}function Aw(i,t){let e=Tw(t);return[`vec4 ${i}( vec4 value ) {`,`	return ${e[1]}( vec4( ${e[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var Rw={[vd]:"Linear",[bd]:"Reinhard",[Sd]:"Cineon",[Md]:"ACESFilmic",[Ed]:"AgX",[Td]:"Neutral",[wd]:"Custom"};function Cw(i,t){let e=Rw[t];return e===void 0?(Yt("WebGLProgram: Unsupported toneMapping:",t),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var mh=new H;function Pw(){_e.getLuminanceCoefficients(mh);let i=mh.x.toFixed(4),t=mh.y.toFixed(4),e=mh.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function Iw(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(Ga).join(`
`)}function Lw(i){let t=[];for(let e in i){let n=i[e];n!==!1&&t.push("#define "+e+" "+n)}return t.join(`
`)}function Dw(i,t){let e={},n=i.getProgramParameter(t,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(t,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:i.getAttribLocation(t,o),locationSize:a}}return e}function Ga(i){return i!==""}function Gg(i,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function Vg(i,t){return i.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var Nw=/^[ \t]*#include +<([\w\d./]+)>/gm;function jd(i){return i.replace(Nw,Uw)}function Uw(i,t){let e=he[t];if(e===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+t+">");return jd(e)}var Fw=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Wg(i){return i.replace(Fw,Ow)}function Ow(i,t,e,n){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function Xg(i){let t=`precision ${i.precision} float;
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
#define LOW_PRECISION`),t}var kw={[gr]:"SHADOWMAP_TYPE_PCF",[xo]:"SHADOWMAP_TYPE_VSM"};function Bw(i){return kw[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var zw={[bo]:"ENVMAP_MODE_REFRACTION"};function Hw(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":zw[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var Gw={[Rc]:"ENVMAP_BLENDING_MULTIPLY",[ig]:"ENVMAP_BLENDING_MIX",[sg]:"ENVMAP_BLENDING_ADD"};function Vw(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":Gw[i.combine]||"ENVMAP_BLENDING_NONE"}function Ww(i,t,e,n){let s=i.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,l=Bw(e),c=e.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",u=Hw(e),d=Vw(e),h=Iw(e),f=Lw(r),p=s.createProgram(),v,m,g=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(v=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(Ga).join(`
`),v.length>0&&(v+=`
`),m=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(Ga).join(`
`),m.length>0&&(m+=`
`)):(v=[Xg(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+u:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+e.diffuseRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexNormals?"#define HAS_NORMAL":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(Ga).join(`
`),m=[Xg(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+c:"",e.envMap?"#define "+u:"",e.envMap?"#define "+d:"",e.envMapPMREM?"#define ENVMAP_MAX_LOD "+e.envMapMaxLod+".0":"",e.envMapPMREM?"#define ENVMAP_SIZE "+e.envMapSize+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.retroreflection?"#define USE_RETROREFLECTION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor?"#define USE_COLOR":"",e.vertexAlphas||e.batchingColor?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==Qi?"#define TONE_MAPPING":"",e.toneMapping!==Qi?he.tonemapping_pars_fragment:"",e.toneMapping!==Qi?Cw("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",he.colorspace_pars_fragment,Aw("linearToOutputTexel",e.outputColorSpace),Pw(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(Ga).join(`
`)),o=jd(o),o=Gg(o,e),o=Vg(o,e),a=jd(a),a=Gg(a,e),a=Vg(a,e),o=Wg(o),a=Wg(a),e.isRawShaderMaterial!==!0&&(g=`#version 300 es
`,v=[h,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+v,m=["#define varying in",e.glslVersion===kd?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===kd?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);let S=g+v+o,M=g+m+a,y=Bg(s,s.VERTEX_SHADER,S),C=Bg(s,s.FRAGMENT_SHADER,M);s.attachShader(p,y),s.attachShader(p,C),e.index0AttributeName!==void 0?s.bindAttribLocation(p,0,e.index0AttributeName):e.hasPositionAttribute===!0&&s.bindAttribLocation(p,0,"position"),s.linkProgram(p);function A(L){if(i.debug.checkShaderErrors){let D=s.getProgramInfoLog(p)||"",B=s.getShaderInfoLog(y)||"",G=s.getShaderInfoLog(C)||"",N=D.trim(),W=B.trim(),q=G.trim(),V=!0,lt=!0;if(s.getProgramParameter(p,s.LINK_STATUS)===!1)if(V=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,p,y,C);else{let Z=Hg(s,y,"vertex"),j=Hg(s,C,"fragment");te("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(p,s.VALIDATE_STATUS)+`

Material Name: `+L.name+`
Material Type: `+L.type+`

Program Info Log: `+N+`
`+Z+`
`+j)}else N!==""?Yt("WebGLProgram: Program Info Log:",N):(W===""||q==="")&&(lt=!1);lt&&(L.diagnostics={runnable:V,programLog:N,vertexShader:{log:W,prefix:v},fragmentShader:{log:q,prefix:m}})}s.deleteShader(y),s.deleteShader(C),x=new Eo(s,p),E=Dw(s,p)}let x;this.getUniforms=function(){return x===void 0&&A(this),x};let E;this.getAttributes=function(){return E===void 0&&A(this),E};let F=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return F===!1&&(F=s.getProgramParameter(p,Mw)),F},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(p),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=ww++,this.cacheKey=t,this.usedTimes=1,this.program=p,this.vertexShader=y,this.fragmentShader=C,this}var Xw=0,Qd=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t,e,n){let s=this._getShaderCacheForMaterial(t);return s.has(e)===!1&&(s.add(e),e.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let n of e)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(t),this}getVertexShaderStage(t){return this._getShaderStage(t.vertexShader)}getFragmentShaderStage(t){return this._getShaderStage(t.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,n=e.get(t);return n===void 0&&(n=new Set,e.set(t,n)),n}_getShaderStage(t){let e=this.shaderCache,n=e.get(t);return n===void 0&&(n=new tf(t),e.set(t,n)),n}},tf=class{constructor(t){this.id=Xw++,this.code=t,this.usedTimes=0}};function $w(i){return i===tr||i===Oa||i===ka}function qw(i,t,e,n,s,r){let o=new co,a=new Qd,l=new Set,c=[],u=new Map,d=n.logarithmicDepthBuffer,h={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function f(x){return l.add(x),x===0?"uv":`uv${x}`}function p(x,E,F,L,D,B){let G=L.fog,N=D.geometry,W=x.isMeshStandardMaterial||x.isMeshLambertMaterial||x.isMeshPhongMaterial?L.environment:null,q=x.isMeshStandardMaterial||x.isMeshLambertMaterial&&!x.envMap||x.isMeshPhongMaterial&&!x.envMap,V=t.get(x.envMap||W,q),lt=h[x.type],Z=n.precision;x.precision!==null&&(Z=n.getMaxPrecision(x.precision),Z!==x.precision&&Yt("WebGLProgram.getParameters:",x.precision,"not supported, using",Z,"instead."));let j=N.morphAttributes.position||N.morphAttributes.normal||N.morphAttributes.color,et=j!==void 0?j.length:0,dt=0;N.morphAttributes.position!==void 0&&(dt=1),N.morphAttributes.normal!==void 0&&(dt=2),N.morphAttributes.color!==void 0&&(dt=3);let ut,tt,mt,yt;if(lt){let Rt=es[lt];ut=Rt.vertexShader,tt=Rt.fragmentShader}else{ut=x.vertexShader,tt=x.fragmentShader;let Rt=a.getVertexShaderStage(x),ae=a.getFragmentShaderStage(x);a.update(x,Rt,ae),mt=Rt.id,yt=ae.id}let At=i.getRenderTarget(),St=i.state.buffers.depth.getReversed(),Xt=D.isInstancedMesh===!0,re=D.isBatchedMesh===!0,Gt=!!x.map,ue=!!x.matcap,le=!!V,ie=le&&V.isPMREMTexture===!0,Ke=!!x.aoMap,He=!!x.lightMap,un=!!x.bumpMap&&x.wireframe===!1,Ne=!!x.normalMap,Rn=!!x.displacementMap,xe=!!x.emissiveMap,xn=!!x.metalnessMap,nn=!!x.roughnessMap,dn=x.anisotropy>0,k=x.clearcoat>0,Ct=x.diffuseRoughness>0,Kt=x.dispersion>0,oe=x.retroreflectivity>0,Mt=x.iridescence>0,Fe=x.sheen>0,Ht=x.transmission>0,qt=dn&&!!x.anisotropyMap,P=k&&!!x.clearcoatMap,w=k&&!!x.clearcoatNormalMap,$=k&&!!x.clearcoatRoughnessMap,ht=Ct&&!!x.diffuseRoughnessMap,ot=Mt&&!!x.iridescenceMap,_t=Mt&&!!x.iridescenceThicknessMap,xt=Fe&&!!x.sheenColorMap,nt=Fe&&!!x.sheenRoughnessMap,st=!!x.specularMap,pt=!!x.specularColorMap,O=!!x.specularIntensityMap,rt=Ht&&!!x.transmissionMap,it=Ht&&!!x.thicknessMap,wt=!!x.gradientMap,gt=!!x.alphaMap,bt=x.alphaTest>0,Wt=!!x.alphaHash,jt=!!x.extensions,ct=Qi;x.toneMapped&&(At===null||At.isXRRenderTarget===!0)&&(ct=i.toneMapping);let kt=ie?V.isCompressedCubeTexture?V.image[0].mipmaps:V.mipmaps:null,Qt={shaderID:lt,shaderType:x.type,shaderName:x.name,vertexShader:ut,fragmentShader:tt,defines:x.defines,customVertexShaderID:mt,customFragmentShaderID:yt,isRawShaderMaterial:x.isRawShaderMaterial===!0,glslVersion:x.glslVersion,precision:Z,batching:re,batchingColor:re&&D._colorsTexture!==null,instancing:Xt,instancingColor:Xt&&D.instanceColor!==null,instancingMorph:Xt&&D.morphTexture!==null,outputColorSpace:At===null?i.outputColorSpace:At.isXRRenderTarget===!0?At.texture.colorSpace:_e.workingColorSpace,alphaToCoverage:!!x.alphaToCoverage,map:Gt,matcap:ue,envMap:le,envMapMode:le&&V.mapping,envMapPMREM:ie,envMapMaxLod:ie?kt.length-1:null,envMapSize:ie?kt[0].width:null,aoMap:Ke,lightMap:He,bumpMap:un,normalMap:Ne,displacementMap:Rn,emissiveMap:xe,normalMapObjectSpace:Ne&&x.normalMapType===ag,normalMapTangentSpace:Ne&&x.normalMapType===Ba,packedNormalMap:Ne&&x.normalMapType===Ba&&$w(x.normalMap.format),metalnessMap:xn,roughnessMap:nn,anisotropy:dn,anisotropyMap:qt,clearcoat:k,clearcoatMap:P,clearcoatNormalMap:w,clearcoatRoughnessMap:$,diffuseRoughness:Ct,diffuseRoughnessMap:ht,dispersion:Kt,retroreflection:oe,iridescence:Mt,iridescenceMap:ot,iridescenceThicknessMap:_t,sheen:Fe,sheenColorMap:xt,sheenRoughnessMap:nt,specularMap:st,specularColorMap:pt,specularIntensityMap:O,transmission:Ht,transmissionMap:rt,thicknessMap:it,gradientMap:wt,opaque:x.transparent===!1&&x.blending===vo&&x.alphaToCoverage===!1,alphaMap:gt,alphaTest:bt,alphaHash:Wt,combine:x.combine,mapUv:Gt&&f(x.map.channel),aoMapUv:Ke&&f(x.aoMap.channel),lightMapUv:He&&f(x.lightMap.channel),bumpMapUv:un&&f(x.bumpMap.channel),normalMapUv:Ne&&f(x.normalMap.channel),displacementMapUv:Rn&&f(x.displacementMap.channel),emissiveMapUv:xe&&f(x.emissiveMap.channel),metalnessMapUv:xn&&f(x.metalnessMap.channel),roughnessMapUv:nn&&f(x.roughnessMap.channel),anisotropyMapUv:qt&&f(x.anisotropyMap.channel),clearcoatMapUv:P&&f(x.clearcoatMap.channel),clearcoatNormalMapUv:w&&f(x.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:$&&f(x.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:ht&&f(x.diffuseRoughnessMap.channel),iridescenceMapUv:ot&&f(x.iridescenceMap.channel),iridescenceThicknessMapUv:_t&&f(x.iridescenceThicknessMap.channel),sheenColorMapUv:xt&&f(x.sheenColorMap.channel),sheenRoughnessMapUv:nt&&f(x.sheenRoughnessMap.channel),specularMapUv:st&&f(x.specularMap.channel),specularColorMapUv:pt&&f(x.specularColorMap.channel),specularIntensityMapUv:O&&f(x.specularIntensityMap.channel),transmissionMapUv:rt&&f(x.transmissionMap.channel),thicknessMapUv:it&&f(x.thicknessMap.channel),alphaMapUv:gt&&f(x.alphaMap.channel),vertexTangents:!!N.attributes.tangent&&(Ne||dn),vertexNormals:!!N.attributes.normal,vertexColors:x.vertexColors,vertexAlphas:x.vertexColors===!0&&!!N.attributes.color&&N.attributes.color.itemSize===4,pointsUvs:D.isPoints===!0&&!!N.attributes.uv&&(Gt||gt),fog:!!G,useFog:x.fog===!0,fogExp2:!!G&&G.isFogExp2,flatShading:x.wireframe===!1&&(x.flatShading===!0||N.attributes.normal===void 0&&Ne===!1&&(x.isMeshLambertMaterial||x.isMeshPhongMaterial||x.isMeshStandardMaterial||x.isMeshPhysicalMaterial)),sizeAttenuation:x.sizeAttenuation===!0,logarithmicDepthBuffer:d,reversedDepthBuffer:St,skinning:D.isSkinnedMesh===!0,hasPositionAttribute:N.attributes.position!==void 0,morphTargets:N.morphAttributes.position!==void 0,morphNormals:N.morphAttributes.normal!==void 0,morphColors:N.morphAttributes.color!==void 0,morphTargetsCount:et,morphTextureStride:dt,numSunLights:E.sun.length,numDirLights:E.directional.length,numPointLights:E.point.length,numSpotLights:E.spot.length,numSpotLightMaps:E.spotLightMap.length,numRectAreaLights:E.rectArea.length,numHemiLights:E.hemi.length,numSunLightShadows:E.sunShadowMap.length,numDirLightShadows:E.directionalShadowMap.length,numPointLightShadows:E.pointShadowMap.length,numSpotLightShadows:E.spotShadowMap.length,numSpotLightShadowsWithMaps:E.numSpotLightShadowsWithMaps,numLightProbes:E.numLightProbes,numLightProbeGrids:B.filter(Rt=>Rt.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:x.dithering,shadowMapEnabled:i.shadowMap.enabled&&F.length>0,shadowMapType:i.shadowMap.type,toneMapping:ct,decodeVideoTexture:Gt&&x.map.isVideoTexture===!0&&_e.getTransfer(x.map.colorSpace)===Ae,decodeVideoTextureEmissive:xe&&x.emissiveMap.isVideoTexture===!0&&_e.getTransfer(x.emissiveMap.colorSpace)===Ae,premultipliedAlpha:x.premultipliedAlpha,doubleSided:x.side===$n,flipSided:x.side===ii,useDepthPacking:x.depthPacking>=0,depthPacking:x.depthPacking||0,index0AttributeName:x.index0AttributeName,extensionClipCullDistance:jt&&x.extensions.clipCullDistance===!0&&e.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(jt&&x.extensions.multiDraw===!0||re)&&e.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:e.has("KHR_parallel_shader_compile"),customProgramCacheKey:x.customProgramCacheKey()};return Qt.vertexUv1s=l.has(1),Qt.vertexUv2s=l.has(2),Qt.vertexUv3s=l.has(3),l.clear(),Qt}function v(x){let E=[];if(x.shaderID?E.push(x.shaderID):(E.push(x.customVertexShaderID),E.push(x.customFragmentShaderID)),x.defines!==void 0)for(let F in x.defines)E.push(F),E.push(x.defines[F]);return x.isRawShaderMaterial===!1&&(m(E,x),g(E,x),E.push(i.outputColorSpace)),E.push(x.customProgramCacheKey),E.join()}function m(x,E){x.push(E.precision),x.push(E.outputColorSpace),x.push(E.envMapMode),x.push(E.envMapPMREM),x.push(E.envMapMaxLod),x.push(E.envMapSize),x.push(E.mapUv),x.push(E.alphaMapUv),x.push(E.lightMapUv),x.push(E.aoMapUv),x.push(E.bumpMapUv),x.push(E.normalMapUv),x.push(E.displacementMapUv),x.push(E.emissiveMapUv),x.push(E.metalnessMapUv),x.push(E.roughnessMapUv),x.push(E.anisotropyMapUv),x.push(E.clearcoatMapUv),x.push(E.clearcoatNormalMapUv),x.push(E.clearcoatRoughnessMapUv),x.push(E.diffuseRoughnessMapUv),x.push(E.iridescenceMapUv),x.push(E.iridescenceThicknessMapUv),x.push(E.sheenColorMapUv),x.push(E.sheenRoughnessMapUv),x.push(E.specularMapUv),x.push(E.specularColorMapUv),x.push(E.specularIntensityMapUv),x.push(E.transmissionMapUv),x.push(E.thicknessMapUv),x.push(E.combine),x.push(E.fogExp2),x.push(E.sizeAttenuation),x.push(E.morphTargetsCount),x.push(E.numSunLights),x.push(E.numDirLights),x.push(E.numPointLights),x.push(E.numSpotLights),x.push(E.numSpotLightMaps),x.push(E.numHemiLights),x.push(E.numRectAreaLights),x.push(E.numSunLightShadows),x.push(E.numDirLightShadows),x.push(E.numPointLightShadows),x.push(E.numSpotLightShadows),x.push(E.numSpotLightShadowsWithMaps),x.push(E.numLightProbes),x.push(E.numLightProbeGrids),x.push(E.shadowMapType),x.push(E.toneMapping),x.push(E.numClippingPlanes),x.push(E.numClipIntersection),x.push(E.depthPacking)}function g(x,E){o.disableAll(),E.instancing&&o.enable(0),E.instancingColor&&o.enable(1),E.instancingMorph&&o.enable(2),E.matcap&&o.enable(3),E.envMap&&o.enable(4),E.normalMapObjectSpace&&o.enable(5),E.normalMapTangentSpace&&o.enable(6),E.clearcoat&&o.enable(7),E.iridescence&&o.enable(8),E.alphaTest&&o.enable(9),E.vertexColors&&o.enable(10),E.vertexAlphas&&o.enable(11),E.vertexUv1s&&o.enable(12),E.vertexUv2s&&o.enable(13),E.vertexUv3s&&o.enable(14),E.vertexTangents&&o.enable(15),E.anisotropy&&o.enable(16),E.alphaHash&&o.enable(17),E.batching&&o.enable(18),E.dispersion&&o.enable(19),E.retroreflection&&o.enable(24),E.diffuseRoughness&&o.enable(25),E.batchingColor&&o.enable(20),E.gradientMap&&o.enable(21),E.packedNormalMap&&o.enable(22),E.vertexNormals&&o.enable(23),x.push(o.mask),o.disableAll(),E.fog&&o.enable(0),E.useFog&&o.enable(1),E.flatShading&&o.enable(2),E.logarithmicDepthBuffer&&o.enable(3),E.reversedDepthBuffer&&o.enable(4),E.skinning&&o.enable(5),E.morphTargets&&o.enable(6),E.morphNormals&&o.enable(7),E.morphColors&&o.enable(8),E.premultipliedAlpha&&o.enable(9),E.shadowMapEnabled&&o.enable(10),E.doubleSided&&o.enable(11),E.flipSided&&o.enable(12),E.useDepthPacking&&o.enable(13),E.dithering&&o.enable(14),E.transmission&&o.enable(15),E.sheen&&o.enable(16),E.opaque&&o.enable(17),E.pointsUvs&&o.enable(18),E.decodeVideoTexture&&o.enable(19),E.decodeVideoTextureEmissive&&o.enable(20),E.alphaToCoverage&&o.enable(21),E.numLightProbeGrids>0&&o.enable(22),E.hasPositionAttribute&&o.enable(23),x.push(o.mask)}function S(x){let E=h[x.type],F;if(E){let L=es[E];F=Tg.clone(L.uniforms)}else F=x.uniforms;return F}function M(x,E){let F=u.get(E);return F!==void 0?++F.usedTimes:(F=new Ww(i,E,x,s),c.push(F),u.set(E,F)),F}function y(x){if(--x.usedTimes===0){let E=c.indexOf(x);c[E]=c[c.length-1],c.pop(),u.delete(x.cacheKey),x.destroy()}}function C(x){a.remove(x)}function A(){a.dispose()}return{getParameters:p,getProgramCacheKey:v,getUniforms:S,acquireProgram:M,releaseProgram:y,releaseShaderCache:C,programs:c,dispose:A}}function Yw(){let i=new WeakMap;function t(o){return i.has(o)}function e(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:t,get:e,remove:n,update:s,dispose:r}}function Zw(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.material.id!==t.material.id?i.material.id-t.material.id:i.materialVariant!==t.materialVariant?i.materialVariant-t.materialVariant:i.z!==t.z?i.z-t.z:i.id-t.id}function $g(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.z!==t.z?t.z-i.z:i.id-t.id}function qg(){let i=[],t=0,e=[],n=[],s=[];function r(){t=0,e.length=0,n.length=0,s.length=0}function o(h){let f=0;return h.isInstancedMesh&&(f+=2),h.isSkinnedMesh&&(f+=1),f}function a(h,f,p,v,m,g){let S=i[t];return S===void 0?(S={id:h.id,object:h,geometry:f,material:p,materialVariant:o(h),groupOrder:v,renderOrder:h.renderOrder,z:m,group:g},i[t]=S):(S.id=h.id,S.object=h,S.geometry=f,S.material=p,S.materialVariant=o(h),S.groupOrder=v,S.renderOrder=h.renderOrder,S.z=m,S.group=g),t++,S}function l(h,f,p,v,m,g,S){S.reversedDepth===!0&&(m=-m);let M=a(h,f,p,v,m,g);p.transmission>0?n.push(M):p.transparent===!0?s.push(M):e.push(M)}function c(h,f,p,v,m,g){let S=a(h,f,p,v,m,g);p.transmission>0?n.unshift(S):p.transparent===!0?s.unshift(S):e.unshift(S)}function u(h,f){e.length>1&&e.sort(h||Zw),n.length>1&&n.sort(f||$g),s.length>1&&s.sort(f||$g)}function d(){for(let h=t,f=i.length;h<f;h++){let p=i[h];if(p.id===null)break;p.id=null,p.object=null,p.geometry=null,p.material=null,p.group=null}}return{opaque:e,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:d,sort:u}}function Kw(){let i=new WeakMap;function t(n,s){let r=i.get(n),o;return r===void 0?(o=new qg,i.set(n,[o])):s>=r.length?(o=new qg,r.push(o)):o=r[s],o}function e(){i=new WeakMap}return{get:t,dispose:e}}function Jw(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={direction:new H,color:new Zt};break;case"SpotLight":e={position:new H,direction:new H,color:new Zt,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new H,color:new Zt,distance:0,decay:0};break;case"HemisphereLight":e={direction:new H,skyColor:new Zt,groundColor:new Zt};break;case"RectAreaLight":e={color:new Zt,position:new H,halfWidth:new H,halfHeight:new H};break}return i[t.id]=e,e}}}function jw(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Vt,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[t.id]=e,e}}}var Qw=0;function tE(i,t){return(t.castShadow?2:0)-(i.castShadow?2:0)+(t.map?1:0)-(i.map?1:0)}function eE(i){let t=new Jw,e=jw(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new H);let s=new H,r=new Oe,o=new Oe;function a(c){let u=0,d=0,h=0;for(let B=0;B<9;B++)n.probe[B].set(0,0,0);let f=0,p=0,v=0,m=0,g=0,S=0,M=0,y=0,C=0,A=0,x=0,E=0,F=0,L=0;c.sort(tE);for(let B=0,G=c.length;B<G;B++){let N=c[B],W=N.color,q=N.intensity,V=N.distance,lt=null;if(N.shadow&&N.shadow.map&&(N.shadow.map.texture.format===tr?lt=N.shadow.map.texture:lt=N.shadow.map.depthTexture||N.shadow.map.texture),N.isAmbientLight)u+=W.r*q,d+=W.g*q,h+=W.b*q;else if(N.isLightProbe){for(let Z=0;Z<9;Z++)n.probe[Z].addScaledVector(N.sh.coefficients[Z],q);L++}else if(N.isSunLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize.copy(j.mapSize).multiply(j.getFrameExtents()),n.sunShadow[p]=et,n.sunShadowMap[p]=lt;let dt=j.getViewportCount();for(let ut=0;ut<dt;ut++)n.sunShadowMatrix[v+ut]=j.getMatrix(ut),n.sunShadowCascade[v+ut]=j._cascadeData[ut];v+=dt,p++}n.sun[f]=Z,f++}else if(N.isDirectionalLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,n.directionalShadow[m]=et,n.directionalShadowMap[m]=lt,n.directionalShadowMatrix[m]=N.shadow.matrix,C++}n.directional[m]=Z,m++}else if(N.isSpotLight){let Z=t.get(N);Z.position.setFromMatrixPosition(N.matrixWorld),Z.color.copy(W).multiplyScalar(q),Z.distance=V,Z.coneCos=Math.cos(N.angle),Z.penumbraCos=Math.cos(N.angle*(1-N.penumbra)),Z.decay=N.decay,n.spot[S]=Z;let j=N.shadow;if(N.map&&(n.spotLightMap[E]=N.map,E++,j.updateMatrices(N),N.castShadow&&F++),n.spotLightMatrix[S]=j.matrix,N.castShadow){let et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,n.spotShadow[S]=et,n.spotShadowMap[S]=lt,x++}S++}else if(N.isRectAreaLight){let Z=t.get(N);Z.color.copy(W).multiplyScalar(q),Z.halfWidth.set(N.width*.5,0,0),Z.halfHeight.set(0,N.height*.5,0),n.rectArea[M]=Z,M++}else if(N.isPointLight){let Z=t.get(N);if(Z.color.copy(N.color).multiplyScalar(N.intensity),Z.distance=N.distance,Z.decay=N.decay,N.castShadow){let j=N.shadow,et=e.get(N);et.shadowIntensity=j.intensity,et.shadowBias=j.bias,et.shadowNormalBias=j.normalBias,et.shadowRadius=j.radius,et.shadowMapSize=j.mapSize,et.shadowCameraNear=j.camera.near,et.shadowCameraFar=j.camera.far,n.pointShadow[g]=et,n.pointShadowMap[g]=lt,n.pointShadowMatrix[g]=N.shadow.matrix,A++}n.point[g]=Z,g++}else if(N.isHemisphereLight){let Z=t.get(N);Z.skyColor.copy(N.color).multiplyScalar(q),Z.groundColor.copy(N.groundColor).multiplyScalar(q),n.hemi[y]=Z,y++}}M>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=Dt.LTC_FLOAT_1,n.rectAreaLTC2=Dt.LTC_FLOAT_2):(n.rectAreaLTC1=Dt.LTC_HALF_1,n.rectAreaLTC2=Dt.LTC_HALF_2)),n.ambient[0]=u,n.ambient[1]=d,n.ambient[2]=h;let D=n.hash;(D.sunLength!==f||D.directionalLength!==m||D.pointLength!==g||D.spotLength!==S||D.rectAreaLength!==M||D.hemiLength!==y||D.numSunShadows!==p||D.numDirectionalShadows!==C||D.numPointShadows!==A||D.numSpotShadows!==x||D.numSpotMaps!==E||D.numLightProbes!==L)&&(n.sun.length=f,n.directional.length=m,n.spot.length=S,n.rectArea.length=M,n.point.length=g,n.hemi.length=y,n.sunShadow.length=p,n.sunShadowMap.length=p,n.sunShadowMatrix.length=v,n.sunShadowCascade.length=v,n.directionalShadow.length=C,n.directionalShadowMap.length=C,n.directionalShadowMatrix.length=C,n.pointShadow.length=A,n.pointShadowMap.length=A,n.pointShadowMatrix.length=A,n.spotShadow.length=x,n.spotShadowMap.length=x,n.spotLightMatrix.length=x+E-F,n.spotLightMap.length=E,n.numSpotLightShadowsWithMaps=F,n.numLightProbes=L,D.sunLength=f,D.directionalLength=m,D.pointLength=g,D.spotLength=S,D.rectAreaLength=M,D.hemiLength=y,D.numSunShadows=p,D.numDirectionalShadows=C,D.numPointShadows=A,D.numSpotShadows=x,D.numSpotMaps=E,D.numLightProbes=L,n.version=Qw++)}function l(c,u){let d=0,h=0,f=0,p=0,v=0,m=0,g=u.matrixWorldInverse;for(let S=0,M=c.length;S<M;S++){let y=c[S];if(y.isSunLight){let C=n.sun[d];C.direction.setFromMatrixPosition(y.matrixWorld),C.direction.transformDirection(g),d++}else if(y.isDirectionalLight){let C=n.directional[h];C.direction.setFromMatrixPosition(y.matrixWorld),s.setFromMatrixPosition(y.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(g),h++}else if(y.isSpotLight){let C=n.spot[p];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(g),C.direction.setFromMatrixPosition(y.matrixWorld),s.setFromMatrixPosition(y.target.matrixWorld),C.direction.sub(s),C.direction.transformDirection(g),p++}else if(y.isRectAreaLight){let C=n.rectArea[v];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(g),o.identity(),r.copy(y.matrixWorld),r.premultiply(g),o.extractRotation(r),C.halfWidth.set(y.width*.5,0,0),C.halfHeight.set(0,y.height*.5,0),C.halfWidth.applyMatrix4(o),C.halfHeight.applyMatrix4(o),v++}else if(y.isPointLight){let C=n.point[f];C.position.setFromMatrixPosition(y.matrixWorld),C.position.applyMatrix4(g),f++}else if(y.isHemisphereLight){let C=n.hemi[m];C.direction.setFromMatrixPosition(y.matrixWorld),C.direction.transformDirection(g),m++}}}return{setup:a,setupView:l,state:n}}function Yg(i){let t=new eE(i),e=[],n=[],s=[];function r(d){u.camera=d,e.length=0,n.length=0,s.length=0}function o(d){d.isLightProbeGrid?s.push(d):e.push(d)}function a(d){n.push(d)}function l(){t.setup(e),s.sort((d,h)=>d.priority-h.priority||d.id-h.id)}function c(d){t.setupView(e,d)}let u={lightsArray:e,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:u,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function nE(i){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new Yg(i),t.set(s,[a])):r>=o.length?(a=new Yg(i),o.push(a)):a=o[r],a}function n(){t=new WeakMap}return{get:e,dispose:n}}var iE=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,sE=`uniform sampler2D shadow_pass;
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
}`,rE=[new H(1,0,0),new H(-1,0,0),new H(0,1,0),new H(0,-1,0),new H(0,0,1),new H(0,0,-1)],oE=[new H(0,-1,0),new H(0,-1,0),new H(0,0,1),new H(0,0,-1),new H(0,-1,0),new H(0,-1,0)],Zg=new Oe,Ha=new H,Yd=new H;function aE(i,t,e){let n=new Gs,s=new Vt,r=new Vt,o=new je,a=new go,l=new mc,c={},u=e.maxTextureSize,d={[Qs]:ii,[ii]:Qs,[$n]:$n},h=new Ti({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new Vt},radius:{value:4}},vertexShader:iE,fragmentShader:sE}),f=h.clone();f.defines.HORIZONTAL_PASS=1;let p=new Ve;p.setAttribute("position",new Ge(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let v=new ke(p,h),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=gr;let g=this.type;this.render=function(A,x,E){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||A.length===0)return;this.type===km&&(Yt("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=gr);let F=i.getRenderTarget(),L=i.getActiveCubeFace(),D=i.getActiveMipmapLevel(),B=i.state;B.setBlending(_r),B.buffers.depth.getReversed()===!0?B.buffers.color.setClear(0,0,0,0):B.buffers.color.setClear(1,1,1,1),B.buffers.depth.setTest(!0),B.setScissorTest(!1);let G=g!==this.type;G&&x.traverse(function(N){N.material&&(Array.isArray(N.material)?N.material.forEach(W=>W.needsUpdate=!0):N.material.needsUpdate=!0)});for(let N=0,W=A.length;N<W;N++){let q=A[N],V=q.shadow;if(V===void 0){Yt("WebGLShadowMap:",q,"has no shadow.");continue}if(V.autoUpdate===!1&&V.needsUpdate===!1)continue;s.copy(V.mapSize);let lt=V.getFrameExtents();s.multiply(lt),r.copy(V.mapSize),(s.x>u||s.y>u)&&(s.x>u&&(r.x=Math.floor(u/lt.x),s.x=r.x*lt.x,V.mapSize.x=r.x),s.y>u&&(r.y=Math.floor(u/lt.y),s.y=r.y*lt.y,V.mapSize.y=r.y));let Z=i.state.buffers.depth.getReversed();if(V.camera._reversedDepth=Z,V.map===null||G===!0){if(V.map!==null&&(V.map.depthTexture!==null&&(V.map.depthTexture.dispose(),V.map.depthTexture=null),V.map.dispose()),this.type===xo){if(q.isPointLight){Yt("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}V.map=new gi(s.x,s.y,{format:tr,type:Bi,minFilter:ei,magFilter:ei,generateMipmaps:!1}),V.map.texture.name=q.name+".shadowMap",V.map.depthTexture=new ys(s.x,s.y,li),V.map.depthTexture.name=q.name+".shadowMapDepth",V.map.depthTexture.format=gs,V.map.depthTexture.compareFunction=null,V.map.depthTexture.minFilter=Fn,V.map.depthTexture.magFilter=Fn}else q.isPointLight?(V.map=new Va(s.x),V.map.depthTexture=new _a(s.x,ki)):(V.map=new gi(s.x,s.y),V.map.depthTexture=new ys(s.x,s.y,ki)),V.map.depthTexture.name=q.name+".shadowMap",V.map.depthTexture.format=gs,this.type===gr?(V.map.depthTexture.compareFunction=Z?Fd:Ud,V.map.depthTexture.minFilter=ei,V.map.depthTexture.magFilter=ei):(V.map.depthTexture.compareFunction=null,V.map.depthTexture.minFilter=Fn,V.map.depthTexture.magFilter=Fn);V.camera.updateProjectionMatrix()}V.map.isWebGLCubeRenderTarget!==!0&&(V.map.width!==s.x||V.map.height!==s.y)&&V.map.setSize(s.x,s.y);let j=V.map.isWebGLCubeRenderTarget?6:V.getViewportCount();q.isPointLight!==!0&&V.updateMatrices(q,E);let et=(V.camera.layers.mask&4294967294)!==0?V.camera.layers:E.layers;for(let dt=0;dt<j;dt++){let ut=V.getCamera(dt);if(q.isPointLight){let tt=V.camera,mt=V.matrix,yt=q.distance||tt.far;yt!==tt.far&&(tt.far=yt,tt.updateProjectionMatrix()),Ha.setFromMatrixPosition(q.matrixWorld),tt.position.copy(Ha),Yd.copy(tt.position),Yd.add(rE[dt]),tt.up.copy(oE[dt]),tt.lookAt(Yd),tt.updateMatrixWorld(),mt.makeTranslation(-Ha.x,-Ha.y,-Ha.z),Zg.multiplyMatrices(tt.projectionMatrix,tt.matrixWorldInverse),V._frustum.setFromProjectionMatrix(Zg,tt.coordinateSystem,tt.reversedDepth)}if(V.map.isWebGLCubeRenderTarget)i.setRenderTarget(V.map,dt),i.clear();else{dt===0&&(i.setRenderTarget(V.map),i.clear());let tt=V.getViewport(dt);o.set(r.x*tt.x,r.y*tt.y,r.x*tt.z,r.y*tt.w),B.viewport(o)}n=V.getFrustum(dt),y(x,E,ut,q,et,this.type)}V.isPointLightShadow!==!0&&this.type===xo&&S(V,E),V.needsUpdate=!1}g=this.type,m.needsUpdate=!1,i.setRenderTarget(F,L,D)};function S(A,x){let E=t.update(v);h.defines.VSM_SAMPLES!==A.blurSamples&&(h.defines.VSM_SAMPLES=A.blurSamples,f.defines.VSM_SAMPLES=A.blurSamples,h.needsUpdate=!0,f.needsUpdate=!0),A.mapPass===null?A.mapPass=new gi(s.x,s.y,{format:tr,type:Bi}):(A.mapPass.width!==A.map.width||A.mapPass.height!==A.map.height)&&A.mapPass.setSize(A.map.width,A.map.height),h.uniforms.shadow_pass.value=A.map.depthTexture,h.uniforms.resolution.value.set(A.map.width,A.map.height),h.uniforms.radius.value=A.radius,i.setRenderTarget(A.mapPass),i.clear(),i.renderBufferDirect(x,null,E,h,v,null),f.uniforms.shadow_pass.value=A.mapPass.texture,f.uniforms.resolution.value.set(A.map.width,A.map.height),f.uniforms.radius.value=A.radius,i.setRenderTarget(A.map),i.clear(),i.renderBufferDirect(x,null,E,f,v,null)}function M(A,x,E,F){let L=null,D=E.isPointLight===!0?A.customDistanceMaterial:A.customDepthMaterial;if(D!==void 0)L=D;else if(L=E.isPointLight===!0?l:a,i.localClippingEnabled&&x.clipShadows===!0&&Array.isArray(x.clippingPlanes)&&x.clippingPlanes.length!==0||x.displacementMap&&x.displacementScale!==0||x.alphaMap&&x.alphaTest>0||x.map&&x.alphaTest>0||x.alphaToCoverage===!0){let B=L.uuid,G=x.uuid,N=c[B];N===void 0&&(N={},c[B]=N);let W=N[G];W===void 0&&(W=L.clone(),N[G]=W,x.addEventListener("dispose",C)),L=W}if(L.visible=x.visible,L.wireframe=x.wireframe,F===xo?L.side=x.shadowSide!==null?x.shadowSide:x.side:L.side=x.shadowSide!==null?x.shadowSide:d[x.side],L.alphaMap=x.alphaMap,L.alphaTest=x.alphaToCoverage===!0?.5:x.alphaTest,L.map=x.map,L.clipShadows=x.clipShadows,L.clippingPlanes=x.clippingPlanes,L.clipIntersection=x.clipIntersection,L.displacementMap=x.displacementMap,L.displacementScale=x.displacementScale,L.displacementBias=x.displacementBias,L.wireframeLinewidth=x.wireframeLinewidth,L.linewidth=x.linewidth,E.isPointLight===!0&&L.isMeshDistanceMaterial===!0){let B=i.properties.get(L);B.light=E}return L}function y(A,x,E,F,L,D){if(A.visible===!1)return;if(A.layers.test(L)&&(A.isMesh||A.isLine||A.isPoints)&&(A.castShadow||A.receiveShadow&&D===xo)&&(!A.frustumCulled||A.intersectsFrustum(n))){A.modelViewMatrix.multiplyMatrices(E.matrixWorldInverse,A.matrixWorld);let N=t.update(A),W=A.material;if(Array.isArray(W)){let q=N.groups;for(let V=0,lt=q.length;V<lt;V++){let Z=q[V],j=W[Z.materialIndex];if(j&&j.visible){let et=M(A,j,F,D);A.onBeforeShadow(i,A,x,E,N,et,Z),i.renderBufferDirect(E,null,N,et,A,Z),A.onAfterShadow(i,A,x,E,N,et,Z)}}}else if(W.visible){let q=M(A,W,F,D);A.onBeforeShadow(i,A,x,E,N,q,null),i.renderBufferDirect(E,null,N,q,A,null),A.onAfterShadow(i,A,x,E,N,q,null)}}let G=A.children;for(let N=0,W=G.length;N<W;N++)y(G[N],x,E,F,L,D)}function C(A){A.target.removeEventListener("dispose",C);for(let E in c){let F=c[E],L=A.target.uuid;L in F&&(F[L].dispose(),delete F[L])}}}function lE(i,t){function e(){let O=!1,rt=new je,it=null,wt=new je(0,0,0,0);return{setMask:function(gt){it!==gt&&!O&&(i.colorMask(gt,gt,gt,gt),it=gt)},setLocked:function(gt){O=gt},setClear:function(gt,bt,Wt,jt,ct){ct===!0&&(gt*=jt,bt*=jt,Wt*=jt),rt.set(gt,bt,Wt,jt),wt.equals(rt)===!1&&(i.clearColor(gt,bt,Wt,jt),wt.copy(rt))},reset:function(){O=!1,it=null,wt.set(-1,0,0,0)}}}function n(){let O=!1,rt=!1,it=null,wt=null,gt=null;return{setReversed:function(bt){if(rt!==bt){let Wt=t.get("EXT_clip_control");bt?Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.ZERO_TO_ONE_EXT):Wt.clipControlEXT(Wt.LOWER_LEFT_EXT,Wt.NEGATIVE_ONE_TO_ONE_EXT),rt=bt;let jt=gt;gt=null,this.setClear(jt)}},getReversed:function(){return rt},setTest:function(bt){bt?St(i.DEPTH_TEST):Xt(i.DEPTH_TEST)},setMask:function(bt){it!==bt&&!O&&(i.depthMask(bt),it=bt)},setFunc:function(bt){if(rt&&(bt=yg[bt]),wt!==bt){switch(bt){case Kl:i.depthFunc(i.NEVER);break;case Jl:i.depthFunc(i.ALWAYS);break;case jl:i.depthFunc(i.LESS);break;case so:i.depthFunc(i.LEQUAL);break;case Ql:i.depthFunc(i.EQUAL);break;case tc:i.depthFunc(i.GEQUAL);break;case ec:i.depthFunc(i.GREATER);break;case nc:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}wt=bt}},setLocked:function(bt){O=bt},setClear:function(bt){gt!==bt&&(gt=bt,rt&&(bt=1-bt),i.clearDepth(bt))},reset:function(){O=!1,it=null,wt=null,gt=null,rt=!1}}}function s(){let O=!1,rt=null,it=null,wt=null,gt=null,bt=null,Wt=null,jt=null,ct=null;return{setTest:function(kt){O||(kt?St(i.STENCIL_TEST):Xt(i.STENCIL_TEST))},setMask:function(kt){rt!==kt&&!O&&(i.stencilMask(kt),rt=kt)},setFunc:function(kt,Qt,Rt){(it!==kt||wt!==Qt||gt!==Rt)&&(i.stencilFunc(kt,Qt,Rt),it=kt,wt=Qt,gt=Rt)},setOp:function(kt,Qt,Rt){(bt!==kt||Wt!==Qt||jt!==Rt)&&(i.stencilOp(kt,Qt,Rt),bt=kt,Wt=Qt,jt=Rt)},setLocked:function(kt){O=kt},setClear:function(kt){ct!==kt&&(i.clearStencil(kt),ct=kt)},reset:function(){O=!1,rt=null,it=null,wt=null,gt=null,bt=null,Wt=null,jt=null,ct=null}}}let r=new e,o=new n,a=new s,l={},c=new WeakMap,u={},d={},h={},f=new WeakMap,p=[],v=null,m=!1,g=null,S=null,M=null,y=null,C=null,A=null,x=null,E=new Zt(0,0,0),F=0,L=!1,D=null,B=null,G=null,N=null,W=null,q=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),V=!1,lt=0,Z=i.getParameter(i.VERSION);Z.indexOf("WebGL")!==-1?(lt=parseFloat(/^WebGL (\d)/.exec(Z)[1]),V=lt>=1):Z.indexOf("OpenGL ES")!==-1&&(lt=parseFloat(/^OpenGL ES (\d)/.exec(Z)[1]),V=lt>=2);let j=null,et={},dt=i.getParameter(i.SCISSOR_BOX),ut=i.getParameter(i.VIEWPORT),tt=new je().fromArray(dt),mt=new je().fromArray(ut);function yt(O,rt,it,wt){let gt=new Uint8Array(4),bt=i.createTexture();i.bindTexture(O,bt),i.texParameteri(O,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(O,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let Wt=0;Wt<it;Wt++)O===i.TEXTURE_3D||O===i.TEXTURE_2D_ARRAY?i.texImage3D(rt,0,i.RGBA,1,1,wt,0,i.RGBA,i.UNSIGNED_BYTE,gt):i.texImage2D(rt+Wt,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,gt);return bt}let At={};At[i.TEXTURE_2D]=yt(i.TEXTURE_2D,i.TEXTURE_2D,1),At[i.TEXTURE_CUBE_MAP]=yt(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),At[i.TEXTURE_2D_ARRAY]=yt(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),At[i.TEXTURE_3D]=yt(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),St(i.DEPTH_TEST),o.setFunc(so),un(!1),Ne(pd),St(i.CULL_FACE),Ke(_r);function St(O){u[O]!==!0&&(i.enable(O),u[O]=!0)}function Xt(O){u[O]!==!1&&(i.disable(O),u[O]=!1)}function re(O,rt){return h[O]!==rt?(i.bindFramebuffer(O,rt),h[O]=rt,O===i.DRAW_FRAMEBUFFER&&(h[i.FRAMEBUFFER]=rt),O===i.FRAMEBUFFER&&(h[i.DRAW_FRAMEBUFFER]=rt),!0):!1}function Gt(O,rt){let it=p,wt=!1;if(O){it=f.get(rt),it===void 0&&(it=[],f.set(rt,it));let gt=O.textures;if(it.length!==gt.length||it[0]!==i.COLOR_ATTACHMENT0){for(let bt=0,Wt=gt.length;bt<Wt;bt++)it[bt]=i.COLOR_ATTACHMENT0+bt;it.length=gt.length,wt=!0}}else it[0]!==i.BACK&&(it[0]=i.BACK,wt=!0);wt&&i.drawBuffers(it)}function ue(O){return v!==O?(i.useProgram(O),v=O,!0):!1}let le={[yr]:i.FUNC_ADD,[zm]:i.FUNC_SUBTRACT,[Hm]:i.FUNC_REVERSE_SUBTRACT};le[Gm]=i.MIN,le[Vm]=i.MAX;let ie={[Wm]:i.ZERO,[Xm]:i.ONE,[$m]:i.SRC_COLOR,[yd]:i.SRC_ALPHA,[jm]:i.SRC_ALPHA_SATURATE,[Km]:i.DST_COLOR,[Ym]:i.DST_ALPHA,[qm]:i.ONE_MINUS_SRC_COLOR,[xd]:i.ONE_MINUS_SRC_ALPHA,[Jm]:i.ONE_MINUS_DST_COLOR,[Zm]:i.ONE_MINUS_DST_ALPHA,[Qm]:i.CONSTANT_COLOR,[tg]:i.ONE_MINUS_CONSTANT_COLOR,[eg]:i.CONSTANT_ALPHA,[ng]:i.ONE_MINUS_CONSTANT_ALPHA};function Ke(O,rt,it,wt,gt,bt,Wt,jt,ct,kt){if(O===_r){m===!0&&(Xt(i.BLEND),m=!1);return}if(m===!1&&(St(i.BLEND),m=!0),O!==Bm){if(O!==g||kt!==L){if((S!==yr||C!==yr)&&(i.blendEquation(i.FUNC_ADD),S=yr,C=yr),kt)switch(O){case vo:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case md:i.blendFunc(i.ONE,i.ONE);break;case gd:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case _d:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:te("WebGLState: Invalid blending: ",O);break}else switch(O){case vo:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case md:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case gd:te("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case _d:te("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:te("WebGLState: Invalid blending: ",O);break}M=null,y=null,A=null,x=null,E.set(0,0,0),F=0,g=O,L=kt}return}gt=gt||rt,bt=bt||it,Wt=Wt||wt,(rt!==S||gt!==C)&&(i.blendEquationSeparate(le[rt],le[gt]),S=rt,C=gt),(it!==M||wt!==y||bt!==A||Wt!==x)&&(i.blendFuncSeparate(ie[it],ie[wt],ie[bt],ie[Wt]),M=it,y=wt,A=bt,x=Wt),(jt.equals(E)===!1||ct!==F)&&(i.blendColor(jt.r,jt.g,jt.b,ct),E.copy(jt),F=ct),g=O,L=!1}function He(O,rt){O.side===$n?Xt(i.CULL_FACE):St(i.CULL_FACE);let it=O.side===ii;rt&&(it=!it),un(it),O.blending===vo&&O.transparent===!1?Ke(_r):Ke(O.blending,O.blendEquation,O.blendSrc,O.blendDst,O.blendEquationAlpha,O.blendSrcAlpha,O.blendDstAlpha,O.blendColor,O.blendAlpha,O.premultipliedAlpha),o.setFunc(O.depthFunc),o.setTest(O.depthTest),o.setMask(O.depthWrite),r.setMask(O.colorWrite);let wt=O.stencilWrite;a.setTest(wt),wt&&(a.setMask(O.stencilWriteMask),a.setFunc(O.stencilFunc,O.stencilRef,O.stencilFuncMask),a.setOp(O.stencilFail,O.stencilZFail,O.stencilZPass)),xe(O.polygonOffset,O.polygonOffsetFactor,O.polygonOffsetUnits),O.alphaToCoverage===!0?St(i.SAMPLE_ALPHA_TO_COVERAGE):Xt(i.SAMPLE_ALPHA_TO_COVERAGE)}function un(O){D!==O&&(O?i.frontFace(i.CW):i.frontFace(i.CCW),D=O)}function Ne(O){O!==Fm?(St(i.CULL_FACE),O!==B&&(O===pd?i.cullFace(i.BACK):O===Om?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):Xt(i.CULL_FACE),B=O}function Rn(O){O!==G&&(V&&i.lineWidth(O),G=O)}function xe(O,rt,it){O?(St(i.POLYGON_OFFSET_FILL),(N!==rt||W!==it)&&(N=rt,W=it,o.getReversed()&&(rt=-rt,it=-it),i.polygonOffset(rt,it))):Xt(i.POLYGON_OFFSET_FILL)}function xn(O){O?St(i.SCISSOR_TEST):Xt(i.SCISSOR_TEST)}function nn(O){O===void 0&&(O=i.TEXTURE0+q-1),j!==O&&(i.activeTexture(O),j=O)}function dn(O,rt,it){it===void 0&&(j===null?it=i.TEXTURE0+q-1:it=j);let wt=et[it];wt===void 0&&(wt={type:void 0,texture:void 0},et[it]=wt),(wt.type!==O||wt.texture!==rt)&&(j!==it&&(i.activeTexture(it),j=it),i.bindTexture(O,rt||At[O]),wt.type=O,wt.texture=rt)}function k(){let O=et[j];O!==void 0&&O.type!==void 0&&(i.bindTexture(O.type,null),O.type=void 0,O.texture=void 0)}function Ct(){try{i.compressedTexImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Kt(){try{i.compressedTexImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function oe(){try{i.texSubImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Mt(){try{i.texSubImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function Fe(){try{i.compressedTexSubImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function Ht(){try{i.compressedTexSubImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function qt(){try{i.texStorage2D(...arguments)}catch(O){te("WebGLState:",O)}}function P(){try{i.texStorage3D(...arguments)}catch(O){te("WebGLState:",O)}}function w(){try{i.texImage2D(...arguments)}catch(O){te("WebGLState:",O)}}function $(){try{i.texImage3D(...arguments)}catch(O){te("WebGLState:",O)}}function ht(O){return d[O]!==void 0?d[O]:i.getParameter(O)}function ot(O,rt){d[O]!==rt&&(i.pixelStorei(O,rt),d[O]=rt)}function _t(O){tt.equals(O)===!1&&(i.scissor(O.x,O.y,O.z,O.w),tt.copy(O))}function xt(O){mt.equals(O)===!1&&(i.viewport(O.x,O.y,O.z,O.w),mt.copy(O))}function nt(O,rt){let it=c.get(rt);it===void 0&&(it=new WeakMap,c.set(rt,it));let wt=it.get(O);wt===void 0&&(wt=i.getUniformBlockIndex(rt,O.name),i.uniformBlockBinding(rt,wt,wt),it.set(O,wt))}function st(O,rt,it){let gt=c.get(rt).get(O);l[gt]!==it&&(i.bindBufferBase(i.UNIFORM_BUFFER,gt,it),l[gt]=it)}function pt(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),u={},d={},j=null,et={},h={},l={},f=new WeakMap,p=[],v=null,m=!1,g=null,S=null,M=null,y=null,C=null,A=null,x=null,E=new Zt(0,0,0),F=0,L=!1,D=null,B=null,G=null,N=null,W=null,tt.set(0,0,i.canvas.width,i.canvas.height),mt.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:St,disable:Xt,bindFramebuffer:re,drawBuffers:Gt,useProgram:ue,setBlending:Ke,setMaterial:He,setFlipSided:un,setCullFace:Ne,setLineWidth:Rn,setPolygonOffset:xe,setScissorTest:xn,activeTexture:nn,bindTexture:dn,unbindTexture:k,compressedTexImage2D:Ct,compressedTexImage3D:Kt,texImage2D:w,texImage3D:$,pixelStorei:ot,getParameter:ht,updateUBOMapping:nt,uniformBlockBinding:st,texStorage2D:qt,texStorage3D:P,texSubImage2D:oe,texSubImage3D:Mt,compressedTexSubImage2D:Fe,compressedTexSubImage3D:Ht,scissor:_t,viewport:xt,reset:pt}}function cE(i,t,e,n,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new Vt,u=new WeakMap,d=new Set,h,f=new WeakMap,p=new Set,v=new FinalizationRegistry(P=>p.delete(P)),m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function g(P,w){return m?new OffscreenCanvas(P,w):la("canvas")}function S(P,w,$){let ht=1,ot=qt(P);if((ot.width>$||ot.height>$)&&(ht=$/Math.max(ot.width,ot.height)),ht<1)if(typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&P instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&P instanceof ImageBitmap||typeof VideoFrame<"u"&&P instanceof VideoFrame){let _t=Math.floor(ht*ot.width),xt=Math.floor(ht*ot.height);h===void 0&&(h=g(_t,xt));let nt=w?g(_t,xt):h;return nt.width=_t,nt.height=xt,nt.getContext("2d").drawImage(P,0,0,_t,xt),Yt("WebGLRenderer: Texture has been resized from ("+ot.width+"x"+ot.height+") to ("+_t+"x"+xt+")."),nt}else return"data"in P&&Yt("WebGLRenderer: Image in DataTexture is too big ("+ot.width+"x"+ot.height+")."),P;return P}function M(P){return P.generateMipmaps}function y(P){i.generateMipmap(P)}function C(P){return P.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:P.isWebGL3DRenderTarget?i.TEXTURE_3D:P.isWebGLArrayRenderTarget||P.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function A(P,w,$,ht,ot,_t=!1){if(P!==null){if(i[P]!==void 0)return i[P];Yt("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+P+"'")}let xt;ht&&(xt=t.get("EXT_texture_norm16"),xt||Yt("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let nt=w;if(w===i.RED&&($===i.FLOAT&&(nt=i.R32F),$===i.HALF_FLOAT&&(nt=i.R16F),$===i.UNSIGNED_BYTE&&(nt=i.R8),$===i.UNSIGNED_SHORT&&xt&&(nt=xt.R16_EXT),$===i.SHORT&&xt&&(nt=xt.R16_SNORM_EXT)),w===i.RED_INTEGER&&($===i.UNSIGNED_BYTE&&(nt=i.R8UI),$===i.UNSIGNED_SHORT&&(nt=i.R16UI),$===i.UNSIGNED_INT&&(nt=i.R32UI),$===i.BYTE&&(nt=i.R8I),$===i.SHORT&&(nt=i.R16I),$===i.INT&&(nt=i.R32I)),w===i.RG&&($===i.FLOAT&&(nt=i.RG32F),$===i.HALF_FLOAT&&(nt=i.RG16F),$===i.UNSIGNED_BYTE&&(nt=i.RG8),$===i.UNSIGNED_SHORT&&xt&&(nt=xt.RG16_EXT),$===i.SHORT&&xt&&(nt=xt.RG16_SNORM_EXT)),w===i.RG_INTEGER&&($===i.UNSIGNED_BYTE&&(nt=i.RG8UI),$===i.UNSIGNED_SHORT&&(nt=i.RG16UI),$===i.UNSIGNED_INT&&(nt=i.RG32UI),$===i.BYTE&&(nt=i.RG8I),$===i.SHORT&&(nt=i.RG16I),$===i.INT&&(nt=i.RG32I)),w===i.RGB_INTEGER&&($===i.UNSIGNED_BYTE&&(nt=i.RGB8UI),$===i.UNSIGNED_SHORT&&(nt=i.RGB16UI),$===i.UNSIGNED_INT&&(nt=i.RGB32UI),$===i.BYTE&&(nt=i.RGB8I),$===i.SHORT&&(nt=i.RGB16I),$===i.INT&&(nt=i.RGB32I)),w===i.RGBA_INTEGER&&($===i.UNSIGNED_BYTE&&(nt=i.RGBA8UI),$===i.UNSIGNED_SHORT&&(nt=i.RGBA16UI),$===i.UNSIGNED_INT&&(nt=i.RGBA32UI),$===i.BYTE&&(nt=i.RGBA8I),$===i.SHORT&&(nt=i.RGBA16I),$===i.INT&&(nt=i.RGBA32I)),w===i.RGB&&($===i.UNSIGNED_SHORT&&xt&&(nt=xt.RGB16_EXT),$===i.SHORT&&xt&&(nt=xt.RGB16_SNORM_EXT),$===i.UNSIGNED_INT_5_9_9_9_REV&&(nt=i.RGB9_E5),$===i.UNSIGNED_INT_10F_11F_11F_REV&&(nt=i.R11F_G11F_B10F)),w===i.RGBA){let st=_t?aa:_e.getTransfer(ot);$===i.FLOAT&&(nt=i.RGBA32F),$===i.HALF_FLOAT&&(nt=i.RGBA16F),$===i.UNSIGNED_BYTE&&(nt=st===Ae?i.SRGB8_ALPHA8:i.RGBA8),$===i.UNSIGNED_SHORT&&xt&&(nt=xt.RGBA16_EXT),$===i.SHORT&&xt&&(nt=xt.RGBA16_SNORM_EXT),$===i.UNSIGNED_SHORT_4_4_4_4&&(nt=i.RGBA4),$===i.UNSIGNED_SHORT_5_5_5_1&&(nt=i.RGB5_A1)}return(nt===i.R16F||nt===i.R32F||nt===i.RG16F||nt===i.RG32F||nt===i.RGBA16F||nt===i.RGBA32F)&&t.get("EXT_color_buffer_float"),nt}function x(P,w){let $;return P?w===null||w===ki||w===vr?$=i.DEPTH24_STENCIL8:w===li?$=i.DEPTH32F_STENCIL8:w===So&&($=i.DEPTH24_STENCIL8,Yt("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):w===null||w===ki||w===vr?$=i.DEPTH_COMPONENT24:w===li?$=i.DEPTH_COMPONENT32F:w===So&&($=i.DEPTH_COMPONENT16),$}function E(P,w){return M(P)===!0||P.isFramebufferTexture&&P.minFilter!==Fn&&P.minFilter!==ei?Math.log2(Math.max(w.width,w.height))+1:P.mipmaps.length>0?P.mipmaps.length:P.isCompressedTexture&&Array.isArray(P.image)?w.mipmaps.length:1}function F(P){let w=new WeakRef(P);n.get(P).__ref=w,p.add(w),v.register(P,w,w)}function L(P){let w=n.get(P).__ref;w!==void 0&&(p.delete(w),v.unregister(w))}function D(P){G(P.target)}function B(P){N(P.target)}function G(P){P.removeEventListener("dispose",D),L(P),q(P),P.isVideoTexture&&u.delete(P),P.isHTMLTexture&&d.delete(P)}function N(P){P.removeEventListener("dispose",B),L(P),lt(P)}function W(){for(let P of p){let w=P.deref();w!==void 0&&(w.isRenderTarget===!0?N(w):G(w))}p.clear(),d.clear()}function q(P){let w=n.get(P);if(w.__webglInit===void 0)return;let $=P.source,ht=f.get($);if(ht){let ot=ht[w.__cacheKey];ot.usedTimes--,ot.usedTimes===0&&V(P),Object.keys(ht).length===0&&f.delete($)}n.remove(P)}function V(P){let w=n.get(P);i.deleteTexture(w.__webglTexture);let $=P.source,ht=f.get($);delete ht[w.__cacheKey],o.memory.textures--}function lt(P){let w=n.get(P);w.__depthDisposeCallback&&w.__depthDisposeCallback();let $=P.depthTexture;if($&&$.renderTarget===P&&G($),P.isWebGLCubeRenderTarget)for(let ot=0;ot<6;ot++){if(Array.isArray(w.__webglFramebuffer[ot]))for(let _t=0;_t<w.__webglFramebuffer[ot].length;_t++)i.deleteFramebuffer(w.__webglFramebuffer[ot][_t]);else i.deleteFramebuffer(w.__webglFramebuffer[ot]);w.__webglDepthbuffer&&i.deleteRenderbuffer(w.__webglDepthbuffer[ot])}else{if(Array.isArray(w.__webglFramebuffer))for(let ot=0;ot<w.__webglFramebuffer.length;ot++)i.deleteFramebuffer(w.__webglFramebuffer[ot]);else i.deleteFramebuffer(w.__webglFramebuffer);if(w.__webglDepthbuffer&&i.deleteRenderbuffer(w.__webglDepthbuffer),w.__webglMultisampledFramebuffer&&i.deleteFramebuffer(w.__webglMultisampledFramebuffer),w.__webglColorRenderbuffer)for(let ot=0;ot<w.__webglColorRenderbuffer.length;ot++)w.__webglColorRenderbuffer[ot]&&i.deleteRenderbuffer(w.__webglColorRenderbuffer[ot]);w.__webglDepthRenderbuffer&&i.deleteRenderbuffer(w.__webglDepthRenderbuffer)}let ht=P.textures;for(let ot=0,_t=ht.length;ot<_t;ot++){let xt=n.get(ht[ot]);xt.__webglTexture&&(i.deleteTexture(xt.__webglTexture),o.memory.textures--),n.remove(ht[ot])}n.remove(P)}let Z=0;function j(){Z=0}function et(){return Z}function dt(P){Z=P}function ut(){let P=Z;return P>=s.maxTextures&&Yt("WebGLTextures: Trying to use "+(P+1)+" texture units while this GPU supports only "+s.maxTextures),Z+=1,P}function tt(P){let w=[];return w.push(P.wrapS),w.push(P.wrapT),w.push(P.wrapR||0),w.push(P.magFilter),w.push(P.minFilter),w.push(P.anisotropy),w.push(P.internalFormat),w.push(P.format),w.push(P.type),w.push(P.generateMipmaps),w.push(P.mipmapsAutoUpdate),w.push(P.premultiplyAlpha),w.push(P.flipY),w.push(P.unpackAlignment),w.push(P.colorSpace),w.join()}function mt(P,w){let $=n.get(P);if(P.isVideoTexture&&Fe(P),P.isRenderTargetTexture===!1&&P.isExternalTexture!==!0&&P.version>0&&$.__version!==P.version){let ht=P.image;if(ht===null)Yt("WebGLRenderer: Texture marked for update but no image data found.");else if(ht.complete===!1)Yt("WebGLRenderer: Texture marked for update but image is incomplete");else{He($,P,w);return}}else P.isExternalTexture&&($.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(i.TEXTURE_2D,$.__webglTexture,i.TEXTURE0+w)}function yt(P,w){let $=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&$.__version!==P.version){He($,P,w);return}else P.isExternalTexture&&($.__webglTexture=P.sourceTexture?P.sourceTexture:null);e.bindTexture(i.TEXTURE_2D_ARRAY,$.__webglTexture,i.TEXTURE0+w)}function At(P,w){let $=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&$.__version!==P.version){He($,P,w);return}e.bindTexture(i.TEXTURE_3D,$.__webglTexture,i.TEXTURE0+w)}function St(P,w){let $=n.get(P);if(P.version>0&&$.__version!==P.version){un($,P,w);return}e.bindTexture(i.TEXTURE_CUBE_MAP,$.__webglTexture,i.TEXTURE0+w)}let Xt={[ic]:i.REPEAT,[Ji]:i.CLAMP_TO_EDGE,[sc]:i.MIRRORED_REPEAT},re={[Fn]:i.NEAREST,[rg]:i.NEAREST_MIPMAP_NEAREST,[La]:i.NEAREST_MIPMAP_LINEAR,[ei]:i.LINEAR,[Ic]:i.LINEAR_MIPMAP_NEAREST,[xs]:i.LINEAR_MIPMAP_LINEAR},Gt={[cg]:i.NEVER,[Od]:i.ALWAYS,[hg]:i.LESS,[Ud]:i.LEQUAL,[ug]:i.EQUAL,[Fd]:i.GEQUAL,[dg]:i.GREATER,[fg]:i.NOTEQUAL};function ue(P,w){if(w.type===li&&t.has("OES_texture_float_linear")===!1&&(w.magFilter===ei||w.magFilter===Ic||w.magFilter===La||w.magFilter===xs||w.minFilter===ei||w.minFilter===Ic||w.minFilter===La||w.minFilter===xs)&&Yt("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(P,i.TEXTURE_WRAP_S,Xt[w.wrapS]),i.texParameteri(P,i.TEXTURE_WRAP_T,Xt[w.wrapT]),(P===i.TEXTURE_3D||P===i.TEXTURE_2D_ARRAY)&&i.texParameteri(P,i.TEXTURE_WRAP_R,Xt[w.wrapR]),i.texParameteri(P,i.TEXTURE_MAG_FILTER,re[w.magFilter]),i.texParameteri(P,i.TEXTURE_MIN_FILTER,re[w.minFilter]),w.compareFunction&&(i.texParameteri(P,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(P,i.TEXTURE_COMPARE_FUNC,Gt[w.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(w.magFilter===Fn||w.minFilter!==La&&w.minFilter!==xs||w.type===li&&t.has("OES_texture_float_linear")===!1)return;if(w.anisotropy>1||n.get(w).__currentAnisotropy){let $=t.get("EXT_texture_filter_anisotropic");i.texParameterf(P,$.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(w.anisotropy,s.getMaxAnisotropy())),n.get(w).__currentAnisotropy=w.anisotropy}}}function le(P,w){let $=!1;P.__webglInit===void 0&&(P.__webglInit=!0,w.addEventListener("dispose",D),F(w));let ht=w.source,ot=f.get(ht);ot===void 0&&(ot={},f.set(ht,ot));let _t=tt(w);if(_t!==P.__cacheKey){ot[_t]===void 0&&(ot[_t]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,$=!0),ot[_t].usedTimes++;let xt=ot[P.__cacheKey];xt!==void 0&&(ot[P.__cacheKey].usedTimes--,xt.usedTimes===0&&V(w)),P.__cacheKey=_t,P.__webglTexture=ot[_t].texture}return $}function ie(P,w,$){return Math.floor(Math.floor(P/$)/w)}function Ke(P,w,$,ht){let _t=P.updateRanges;if(_t.length===0)e.texSubImage2D(i.TEXTURE_2D,0,0,0,w.width,w.height,$,ht,w.data);else{_t.sort((O,rt)=>O.start-rt.start);let xt=0;for(let O=1;O<_t.length;O++){let rt=_t[xt],it=_t[O],wt=rt.start+rt.count,gt=ie(it.start,w.width,4),bt=ie(rt.start,w.width,4);it.start<=wt+1&&gt===bt&&ie(it.start+it.count-1,w.width,4)===gt?rt.count=Math.max(rt.count,it.start+it.count-rt.start):(++xt,_t[xt]=it)}_t.length=xt+1;let nt=e.getParameter(i.UNPACK_ROW_LENGTH),st=e.getParameter(i.UNPACK_SKIP_PIXELS),pt=e.getParameter(i.UNPACK_SKIP_ROWS);e.pixelStorei(i.UNPACK_ROW_LENGTH,w.width);for(let O=0,rt=_t.length;O<rt;O++){let it=_t[O],wt=Math.floor(it.start/4),gt=Math.ceil(it.count/4),bt=wt%w.width,Wt=Math.floor(wt/w.width),jt=gt,ct=1;e.pixelStorei(i.UNPACK_SKIP_PIXELS,bt),e.pixelStorei(i.UNPACK_SKIP_ROWS,Wt),e.texSubImage2D(i.TEXTURE_2D,0,bt,Wt,jt,ct,$,ht,w.data)}P.clearUpdateRanges(),e.pixelStorei(i.UNPACK_ROW_LENGTH,nt),e.pixelStorei(i.UNPACK_SKIP_PIXELS,st),e.pixelStorei(i.UNPACK_SKIP_ROWS,pt)}}function He(P,w,$){let ht=i.TEXTURE_2D;(w.isDataArrayTexture||w.isCompressedArrayTexture)&&(ht=i.TEXTURE_2D_ARRAY),w.isData3DTexture&&(ht=i.TEXTURE_3D);let ot=le(P,w),_t=w.source;e.bindTexture(ht,P.__webglTexture,i.TEXTURE0+$);let xt=n.get(_t);if(_t.version!==xt.__version||ot===!0){if(e.activeTexture(i.TEXTURE0+$),(typeof ImageBitmap<"u"&&w.image instanceof ImageBitmap)===!1){let ct=_e.getPrimaries(_e.workingColorSpace),kt=w.colorSpace===bs?null:_e.getPrimaries(w.colorSpace),Qt=w.colorSpace===bs||ct===kt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,w.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,w.premultiplyAlpha),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Qt)}e.pixelStorei(i.UNPACK_ALIGNMENT,w.unpackAlignment);let st=S(w.image,!1,s.maxTextureSize);st=Ht(w,st);let pt=r.convert(w.format,w.colorSpace),O=r.convert(w.type),rt=A(w.internalFormat,pt,O,w.normalized,w.colorSpace,w.isVideoTexture);ue(ht,w);let it,wt=w.mipmaps,gt=w.isVideoTexture!==!0,bt=xt.__version===void 0||ot===!0,Wt=_t.dataReady,jt=E(w,st);if(w.isDepthTexture)rt=x(w.format===vs,w.type),bt&&(gt?e.texStorage2D(i.TEXTURE_2D,1,rt,st.width,st.height):e.texImage2D(i.TEXTURE_2D,0,rt,st.width,st.height,0,pt,O,null));else if(w.isDataTexture)if(wt.length>0){gt&&bt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,wt[0].width,wt[0].height);for(let ct=0,kt=wt.length;ct<kt;ct++)it=wt[ct],gt?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,pt,O,it.data):e.texImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,pt,O,it.data);w.generateMipmaps=!1}else gt?(bt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,st.width,st.height),Wt&&Ke(w,st,pt,O)):e.texImage2D(i.TEXTURE_2D,0,rt,st.width,st.height,0,pt,O,st.data);else if(w.isCompressedTexture)if(w.isCompressedArrayTexture){gt&&bt&&e.texStorage3D(i.TEXTURE_2D_ARRAY,jt,rt,wt[0].width,wt[0].height,st.depth);for(let ct=0,kt=wt.length;ct<kt;ct++)if(it=wt[ct],w.format!==si)if(pt!==null)if(gt){if(Wt)if(w.layerUpdates.size>0){let Qt=$d(it.width,it.height,w.format,w.type);for(let Rt of w.layerUpdates){let ae=it.data.subarray(Rt*Qt/it.data.BYTES_PER_ELEMENT,(Rt+1)*Qt/it.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,Rt,it.width,it.height,1,pt,ae)}}else e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,0,it.width,it.height,st.depth,pt,it.data)}else e.compressedTexImage3D(i.TEXTURE_2D_ARRAY,ct,rt,it.width,it.height,st.depth,0,it.data,0,0);else Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else gt?Wt&&e.texSubImage3D(i.TEXTURE_2D_ARRAY,ct,0,0,0,it.width,it.height,st.depth,pt,O,it.data):e.texImage3D(i.TEXTURE_2D_ARRAY,ct,rt,it.width,it.height,st.depth,0,pt,O,it.data);w.layerUpdates.size>0&&w.clearLayerUpdates()}else{gt&&bt&&e.texStorage2D(i.TEXTURE_2D,jt,rt,wt[0].width,wt[0].height);for(let ct=0,kt=wt.length;ct<kt;ct++)it=wt[ct],w.format!==si?pt!==null?gt?Wt&&e.compressedTexSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,pt,it.data):e.compressedTexImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,it.data):Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):gt?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,it.width,it.height,pt,O,it.data):e.texImage2D(i.TEXTURE_2D,ct,rt,it.width,it.height,0,pt,O,it.data)}else if(w.isDataArrayTexture)if(gt){if(bt&&e.texStorage3D(i.TEXTURE_2D_ARRAY,jt,rt,st.width,st.height,st.depth),Wt)if(w.layerUpdates.size>0){let ct=$d(st.width,st.height,w.format,w.type);for(let kt of w.layerUpdates){let Qt=st.data.subarray(kt*ct/st.data.BYTES_PER_ELEMENT,(kt+1)*ct/st.data.BYTES_PER_ELEMENT);e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,kt,st.width,st.height,1,pt,O,Qt)}w.clearLayerUpdates()}else e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,st.width,st.height,st.depth,pt,O,st.data)}else e.texImage3D(i.TEXTURE_2D_ARRAY,0,rt,st.width,st.height,st.depth,0,pt,O,st.data);else if(w.isData3DTexture)gt?(bt&&e.texStorage3D(i.TEXTURE_3D,jt,rt,st.width,st.height,st.depth),Wt&&e.texSubImage3D(i.TEXTURE_3D,0,0,0,0,st.width,st.height,st.depth,pt,O,st.data)):e.texImage3D(i.TEXTURE_3D,0,rt,st.width,st.height,st.depth,0,pt,O,st.data);else if(w.isFramebufferTexture){if(bt)if(gt)e.texStorage2D(i.TEXTURE_2D,jt,rt,st.width,st.height);else{let ct=st.width,kt=st.height;for(let Qt=0;Qt<jt;Qt++)e.texImage2D(i.TEXTURE_2D,Qt,rt,ct,kt,0,pt,O,null),ct>>=1,kt>>=1}}else if(w.isHTMLTexture){if("texElementImage2D"in i){let ct=i.canvas;if(ct.hasAttribute("layoutsubtree")||ct.setAttribute("layoutsubtree","true"),st.parentNode!==ct){ct.appendChild(st),d.add(w),ct.onpaint=kt=>{let Qt=kt.changedElements;for(let Rt of d)Qt.includes(Rt.image)&&(Rt.needsUpdate=!0)},ct.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,st);else{let Qt=i.RGBA,Rt=i.RGBA,ae=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,Qt,Rt,ae,st)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(wt.length>0){if(gt&&bt){let ct=qt(wt[0]);e.texStorage2D(i.TEXTURE_2D,jt,rt,ct.width,ct.height)}for(let ct=0,kt=wt.length;ct<kt;ct++)it=wt[ct],gt?Wt&&e.texSubImage2D(i.TEXTURE_2D,ct,0,0,pt,O,it):e.texImage2D(i.TEXTURE_2D,ct,rt,pt,O,it);w.generateMipmaps=!1}else if(gt){if(bt){let ct=qt(st);e.texStorage2D(i.TEXTURE_2D,jt,rt,ct.width,ct.height)}Wt&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,pt,O,st)}else e.texImage2D(i.TEXTURE_2D,0,rt,pt,O,st);M(w)&&w.mipmapsAutoUpdate===!0&&y(ht),xt.__version=_t.version,w.onUpdate&&w.onUpdate(w)}P.__version=w.version}function un(P,w,$){if(w.image.length!==6)return;let ht=le(P,w),ot=w.source;e.bindTexture(i.TEXTURE_CUBE_MAP,P.__webglTexture,i.TEXTURE0+$);let _t=n.get(ot);if(ot.version!==_t.__version||ht===!0){e.activeTexture(i.TEXTURE0+$);let xt=_e.getPrimaries(_e.workingColorSpace),nt=w.colorSpace===bs?null:_e.getPrimaries(w.colorSpace),st=w.colorSpace===bs||xt===nt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,w.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,w.premultiplyAlpha),e.pixelStorei(i.UNPACK_ALIGNMENT,w.unpackAlignment),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,st);let pt=w.isCompressedTexture||w.image[0].isCompressedTexture,O=w.image[0]&&w.image[0].isDataTexture,rt=[];for(let Rt=0;Rt<6;Rt++)!pt&&!O?rt[Rt]=S(w.image[Rt],!0,s.maxCubemapSize):rt[Rt]=O?w.image[Rt].image:w.image[Rt],rt[Rt]=Ht(w,rt[Rt]);let it=rt[0],wt=r.convert(w.format,w.colorSpace),gt=r.convert(w.type),bt=A(w.internalFormat,wt,gt,w.normalized,w.colorSpace),Wt=w.isVideoTexture!==!0,jt=_t.__version===void 0||ht===!0,ct=ot.dataReady,kt=E(w,it);ue(i.TEXTURE_CUBE_MAP,w);let Qt;if(w.isDepthTexture){if(bt=x(w.format===vs,w.type),jt)if(Wt)e.texStorage2D(i.TEXTURE_CUBE_MAP,1,bt,it.width,it.height);else for(let Rt=0;Rt<6;Rt++)e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,0,bt,it.width,it.height,0,wt,gt,null)}else if(pt){Wt&&jt&&e.texStorage2D(i.TEXTURE_CUBE_MAP,kt,bt,it.width,it.height);for(let Rt=0;Rt<6;Rt++){Qt=rt[Rt].mipmaps;for(let ae=0;ae<Qt.length;ae++){let We=Qt[ae];w.format!==si?wt!==null?Wt?ct&&e.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae,0,0,We.width,We.height,wt,We.data):e.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae,bt,We.width,We.height,0,We.data):Yt("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae,0,0,We.width,We.height,wt,gt,We.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae,bt,We.width,We.height,0,wt,gt,We.data)}}}else{if(Qt=w.mipmaps,Wt&&jt){Qt.length>0&&kt++;let Rt=qt(rt[0]);e.texStorage2D(i.TEXTURE_CUBE_MAP,kt,bt,Rt.width,Rt.height)}for(let Rt=0;Rt<6;Rt++)if(O){Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,0,0,0,rt[Rt].width,rt[Rt].height,wt,gt,rt[Rt].data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,0,bt,rt[Rt].width,rt[Rt].height,0,wt,gt,rt[Rt].data);for(let ae=0;ae<Qt.length;ae++){let Yn=Qt[ae].image[Rt].image;Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae+1,0,0,Yn.width,Yn.height,wt,gt,Yn.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae+1,bt,Yn.width,Yn.height,0,wt,gt,Yn.data)}}else{Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,0,0,0,wt,gt,rt[Rt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,0,bt,wt,gt,rt[Rt]);for(let ae=0;ae<Qt.length;ae++){let We=Qt[ae];Wt?ct&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae+1,0,0,wt,gt,We.image[Rt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Rt,ae+1,bt,wt,gt,We.image[Rt])}}}M(w)&&w.mipmapsAutoUpdate===!0&&y(i.TEXTURE_CUBE_MAP),_t.__version=ot.version,w.onUpdate&&w.onUpdate(w)}P.__version=w.version}function Ne(P,w,$,ht,ot,_t){let xt=r.convert($.format,$.colorSpace),nt=r.convert($.type),st=A($.internalFormat,xt,nt,$.normalized,$.colorSpace),pt=n.get(w),O=n.get($);if(O.__renderTarget=w,!pt.__hasExternalTextures){let rt=Math.max(1,w.width>>_t),it=Math.max(1,w.height>>_t);ot===i.TEXTURE_3D||ot===i.TEXTURE_2D_ARRAY?e.texImage3D(ot,_t,st,rt,it,w.depth,0,xt,nt,null):e.texImage2D(ot,_t,st,rt,it,0,xt,nt,null)}e.bindFramebuffer(i.FRAMEBUFFER,P),Mt(w)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,ht,ot,O.__webglTexture,0,oe(w)):(ot===i.TEXTURE_2D||ot>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&ot<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,ht,ot,O.__webglTexture,_t),e.bindFramebuffer(i.FRAMEBUFFER,null)}function Rn(P,w,$){if(i.bindRenderbuffer(i.RENDERBUFFER,P),w.depthBuffer){let ht=w.depthTexture,ot=ht&&ht.isDepthTexture?ht.type:null,_t=x(w.stencilBuffer,ot),xt=w.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;Mt(w)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,oe(w),_t,w.width,w.height):$?i.renderbufferStorageMultisample(i.RENDERBUFFER,oe(w),_t,w.width,w.height):i.renderbufferStorage(i.RENDERBUFFER,_t,w.width,w.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,xt,i.RENDERBUFFER,P)}else{let ht=w.textures;for(let ot=0;ot<ht.length;ot++){let _t=ht[ot],xt=r.convert(_t.format,_t.colorSpace),nt=r.convert(_t.type),st=A(_t.internalFormat,xt,nt,_t.normalized,_t.colorSpace);Mt(w)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,oe(w),st,w.width,w.height):$?i.renderbufferStorageMultisample(i.RENDERBUFFER,oe(w),st,w.width,w.height):i.renderbufferStorage(i.RENDERBUFFER,st,w.width,w.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function xe(P,w,$){let ht=w.isWebGLCubeRenderTarget===!0;if(e.bindFramebuffer(i.FRAMEBUFFER,P),!(w.depthTexture&&w.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let ot=n.get(w.depthTexture);ot.__renderTarget=w;let _t=ht?w.depthTexture.image[0]:w.depthTexture.image;(!ot.__webglTexture||_t.width!==w.width||_t.height!==w.height)&&(_t.width=w.width,_t.height=w.height,w.depthTexture.needsUpdate=!0),ht?St(w.depthTexture,0):mt(w.depthTexture,0);let xt=ot.__webglTexture,nt=oe(w),st=ht?i.TEXTURE_CUBE_MAP_POSITIVE_X+$:i.TEXTURE_2D,pt=w.depthTexture.format===vs?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(w.depthTexture.format===gs)Mt(w)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,pt,st,xt,0,nt):i.framebufferTexture2D(i.FRAMEBUFFER,pt,st,xt,0);else if(w.depthTexture.format===vs)Mt(w)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,pt,st,xt,0,nt):i.framebufferTexture2D(i.FRAMEBUFFER,pt,st,xt,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function xn(P){let w=n.get(P),$=P.isWebGLCubeRenderTarget===!0;if(w.__boundDepthTexture!==P.depthTexture){let ht=P.depthTexture;if(w.__depthDisposeCallback&&w.__depthDisposeCallback(),ht){let ot=()=>{delete w.__boundDepthTexture,delete w.__depthDisposeCallback,ht.removeEventListener("dispose",ot)};ht.addEventListener("dispose",ot),w.__depthDisposeCallback=ot}w.__boundDepthTexture=ht}if(P.depthTexture&&!w.__autoAllocateDepthBuffer)if($)for(let ht=0;ht<6;ht++)xe(w.__webglFramebuffer[ht],P,ht);else P.texture.mipmaps.length>0?xe(w.__webglFramebuffer[0],P,0):xe(w.__webglFramebuffer,P,0);else if($){w.__webglDepthbuffer=[];for(let ht=0;ht<6;ht++)if(e.bindFramebuffer(i.FRAMEBUFFER,w.__webglFramebuffer[ht]),w.__webglDepthbuffer[ht]===void 0)w.__webglDepthbuffer[ht]=i.createRenderbuffer(),Rn(w.__webglDepthbuffer[ht],P,!1);else{let ot=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,_t=w.__webglDepthbuffer[ht];i.bindRenderbuffer(i.RENDERBUFFER,_t),i.framebufferRenderbuffer(i.FRAMEBUFFER,ot,i.RENDERBUFFER,_t)}}else if(P.texture.mipmaps.length>0?e.bindFramebuffer(i.FRAMEBUFFER,w.__webglFramebuffer[0]):e.bindFramebuffer(i.FRAMEBUFFER,w.__webglFramebuffer),w.__webglDepthbuffer===void 0)w.__webglDepthbuffer=i.createRenderbuffer(),Rn(w.__webglDepthbuffer,P,!1);else{let ot=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,_t=w.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,_t),i.framebufferRenderbuffer(i.FRAMEBUFFER,ot,i.RENDERBUFFER,_t)}e.bindFramebuffer(i.FRAMEBUFFER,null)}function nn(P,w,$){let ht=n.get(P);w!==void 0&&Ne(ht.__webglFramebuffer,P,P.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),$!==void 0&&xn(P)}function dn(P){let w=P.texture,$=n.get(P),ht=n.get(w);P.addEventListener("dispose",B),F(P);let ot=P.textures,_t=P.isWebGLCubeRenderTarget===!0,xt=ot.length>1;if(xt||(ht.__webglTexture===void 0&&(ht.__webglTexture=i.createTexture()),ht.__version=w.version,o.memory.textures++),_t){$.__webglFramebuffer=[];for(let nt=0;nt<6;nt++)if(w.mipmaps.length>0){$.__webglFramebuffer[nt]=[];for(let st=0;st<w.mipmaps.length;st++)$.__webglFramebuffer[nt][st]=i.createFramebuffer()}else $.__webglFramebuffer[nt]=i.createFramebuffer()}else{if(w.mipmaps.length>0){$.__webglFramebuffer=[];for(let nt=0;nt<w.mipmaps.length;nt++)$.__webglFramebuffer[nt]=i.createFramebuffer()}else $.__webglFramebuffer=i.createFramebuffer();if(xt)for(let nt=0,st=ot.length;nt<st;nt++){let pt=n.get(ot[nt]);pt.__webglTexture===void 0&&(pt.__webglTexture=i.createTexture(),o.memory.textures++)}if(P.samples>0&&Mt(P)===!1){$.__webglMultisampledFramebuffer=i.createFramebuffer(),$.__webglColorRenderbuffer=[],e.bindFramebuffer(i.FRAMEBUFFER,$.__webglMultisampledFramebuffer);for(let nt=0;nt<ot.length;nt++){let st=ot[nt];$.__webglColorRenderbuffer[nt]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,$.__webglColorRenderbuffer[nt]);let pt=r.convert(st.format,st.colorSpace),O=r.convert(st.type),rt=A(st.internalFormat,pt,O,st.normalized,st.colorSpace,P.isXRRenderTarget===!0),it=oe(P);i.renderbufferStorageMultisample(i.RENDERBUFFER,it,rt,P.width,P.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+nt,i.RENDERBUFFER,$.__webglColorRenderbuffer[nt])}i.bindRenderbuffer(i.RENDERBUFFER,null),P.depthBuffer&&($.__webglDepthRenderbuffer=i.createRenderbuffer(),Rn($.__webglDepthRenderbuffer,P,!0)),e.bindFramebuffer(i.FRAMEBUFFER,null)}}if(_t){e.bindTexture(i.TEXTURE_CUBE_MAP,ht.__webglTexture),ue(i.TEXTURE_CUBE_MAP,w);for(let nt=0;nt<6;nt++)if(w.mipmaps.length>0)for(let st=0;st<w.mipmaps.length;st++)Ne($.__webglFramebuffer[nt][st],P,w,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+nt,st);else Ne($.__webglFramebuffer[nt],P,w,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+nt,0);M(w)?y(i.TEXTURE_CUBE_MAP):w.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,w.mipmaps.length-1),e.unbindTexture()}else if(xt){for(let nt=0,st=ot.length;nt<st;nt++){let pt=ot[nt],O=n.get(pt),rt=i.TEXTURE_2D;(P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(rt=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(rt,O.__webglTexture),ue(rt,pt),Ne($.__webglFramebuffer,P,pt,i.COLOR_ATTACHMENT0+nt,rt,0),M(pt)&&y(rt)}e.unbindTexture()}else{let nt=i.TEXTURE_2D;if((P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(nt=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(nt,ht.__webglTexture),ue(nt,w),w.mipmaps.length>0)for(let st=0;st<w.mipmaps.length;st++)Ne($.__webglFramebuffer[st],P,w,i.COLOR_ATTACHMENT0,nt,st);else Ne($.__webglFramebuffer,P,w,i.COLOR_ATTACHMENT0,nt,0);M(w)?y(nt):w.mipmaps.length>0&&i.texParameteri(nt,i.TEXTURE_MAX_LEVEL,w.mipmaps.length-1),e.unbindTexture()}P.depthBuffer&&xn(P)}function k(P){let w=P.textures;for(let $=0,ht=w.length;$<ht;$++){let ot=w[$];if(M(ot)&&ot.mipmapsAutoUpdate===!0){let _t=C(P),xt=n.get(ot).__webglTexture;e.bindTexture(_t,xt),y(_t),e.unbindTexture()}}}let Ct=[];function Kt(P){if(P.samples>0){if(Mt(P)===!1){let w=P.textures,$=P.width,ht=P.height,ot=i.COLOR_BUFFER_BIT,_t=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,xt=n.get(P),nt=w.length>1;if(nt)for(let pt=0;pt<w.length;pt++)e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+pt,i.RENDERBUFFER,null),e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+pt,i.TEXTURE_2D,null,0);e.bindFramebuffer(i.READ_FRAMEBUFFER,xt.__webglMultisampledFramebuffer),P.texture.mipmaps.length>0?e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglFramebuffer[0]):e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglFramebuffer);for(let pt=0;pt<w.length;pt++){if(P.resolveDepthBuffer&&(P.depthBuffer&&(ot|=i.DEPTH_BUFFER_BIT),P.stencilBuffer&&P.resolveStencilBuffer&&(ot|=i.STENCIL_BUFFER_BIT)),nt){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,xt.__webglColorRenderbuffer[pt]);let O=n.get(w[pt]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,O,0)}i.blitFramebuffer(0,0,$,ht,0,0,$,ht,ot,i.NEAREST),l===!0&&(Ct.length=0,Ct.push(i.COLOR_ATTACHMENT0+pt),P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&Ct.push(_t),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Ct))}if(e.bindFramebuffer(i.READ_FRAMEBUFFER,null),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),nt)for(let pt=0;pt<w.length;pt++){e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+pt,i.RENDERBUFFER,xt.__webglColorRenderbuffer[pt]);let O=n.get(w[pt]).__webglTexture;e.bindFramebuffer(i.FRAMEBUFFER,xt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+pt,i.TEXTURE_2D,O,0)}e.bindFramebuffer(i.DRAW_FRAMEBUFFER,xt.__webglMultisampledFramebuffer)}else if(P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&l){let w=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[w])}}}function oe(P){return Math.min(s.maxSamples,P.samples)}function Mt(P){let w=n.get(P);return P.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&w.__useRenderToTexture!==!1}function Fe(P){let w=o.render.frame;u.get(P)!==w&&(u.set(P,w),P.update())}function Ht(P,w){let $=P.colorSpace,ht=P.format,ot=P.type;return P.isCompressedTexture===!0||P.isVideoTexture===!0||$!==oa&&$!==bs&&(_e.getTransfer($)===Ae?(ht!==si||ot!==ai)&&Yt("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):te("WebGLTextures: Unsupported texture color space:",$)),w}function qt(P){return typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement?(c.width=P.naturalWidth||P.width,c.height=P.naturalHeight||P.height):typeof VideoFrame<"u"&&P instanceof VideoFrame?(c.width=P.displayWidth,c.height=P.displayHeight):(c.width=P.width,c.height=P.height),c}this.allocateTextureUnit=ut,this.resetTextureUnits=j,this.getTextureUnits=et,this.setTextureUnits=dt,this.setTexture2D=mt,this.setTexture2DArray=yt,this.setTexture3D=At,this.setTextureCube=St,this.rebindTextures=nn,this.setupRenderTarget=dn,this.updateRenderTargetMipmap=k,this.updateMultisampleRenderTarget=Kt,this.setupDepthRenderbuffer=xn,this.setupFrameBufferTexture=Ne,this.useMultisampledRTT=Mt,this.dispose=W}function hE(i,t){function e(n,s=bs){let r,o=_e.getTransfer(s);if(n===ai)return i.UNSIGNED_BYTE;if(n===Dc)return i.UNSIGNED_SHORT_4_4_4_4;if(n===Nc)return i.UNSIGNED_SHORT_5_5_5_1;if(n===Pd)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===Id)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===Rd)return i.BYTE;if(n===Cd)return i.SHORT;if(n===So)return i.UNSIGNED_SHORT;if(n===Lc)return i.INT;if(n===ki)return i.UNSIGNED_INT;if(n===li)return i.FLOAT;if(n===Bi)return i.HALF_FLOAT;if(n===Ld)return i.ALPHA;if(n===Dd)return i.RGB;if(n===si)return i.RGBA;if(n===gs)return i.DEPTH_COMPONENT;if(n===vs)return i.DEPTH_STENCIL;if(n===Nd)return i.RED;if(n===Uc)return i.RED_INTEGER;if(n===tr)return i.RG;if(n===Fc)return i.RG_INTEGER;if(n===Oc)return i.RGBA_INTEGER;if(n===Da||n===Na||n===Ua||n===Fa)if(o===Ae)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===Da)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Na)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===Ua)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===Fa)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===Da)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Na)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===Ua)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===Fa)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===kc||n===Bc||n===zc||n===Hc)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===kc)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===Bc)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===zc)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===Hc)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===Gc||n===Vc||n===Wc||n===Xc||n===$c||n===Oa||n===qc)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(n===Gc||n===Vc)return o===Ae?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===Wc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===Xc)return r.COMPRESSED_R11_EAC;if(n===$c)return r.COMPRESSED_SIGNED_R11_EAC;if(n===Oa)return r.COMPRESSED_RG11_EAC;if(n===qc)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===Yc||n===Zc||n===Kc||n===Jc||n===jc||n===Qc||n===th||n===eh||n===nh||n===ih||n===sh||n===rh||n===oh||n===ah)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(n===Yc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===Zc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===Kc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===Jc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===jc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===Qc)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===th)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===eh)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===nh)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===ih)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===sh)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===rh)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===oh)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===ah)return o===Ae?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===lh||n===ch||n===hh)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(n===lh)return o===Ae?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===ch)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===hh)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===uh||n===dh||n===ka||n===fh)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(n===uh)return r.COMPRESSED_RED_RGTC1_EXT;if(n===dh)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===ka)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===fh)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===vr?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:e}}var uE=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,dE=`
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

}`,ef=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e){if(this.texture===null){let n=new ya(t.texture);(t.depthNear!==e.depthNear||t.depthFar!==e.depthFar)&&(this.depthNear=t.depthNear,this.depthFar=t.depthFar),this.texture=n}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,n=new Ti({vertexShader:uE,fragmentShader:dE,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new ke(new pr(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},nf=class extends Ui{constructor(t,e){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,u=null,d=null,h=null,f=null,p=null,v=typeof XRWebGLBinding<"u",m=new ef,g={},S=e.getContextAttributes(),M=null,y=null,C=[],A=[],x=new Vt,E=null,F=null,L=new ti;L.viewport=new je;let D=new ti;D.viewport=new je;let B=[L,D],G=new Ac,N=null,W=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(tt){let mt=C[tt];return mt===void 0&&(mt=new ho,C[tt]=mt),mt.getTargetRaySpace()},this.getControllerGrip=function(tt){let mt=C[tt];return mt===void 0&&(mt=new ho,C[tt]=mt),mt.getGripSpace()},this.getHand=function(tt){let mt=C[tt];return mt===void 0&&(mt=new ho,C[tt]=mt),mt.getHandSpace()};function q(tt){let mt=A.indexOf(tt.inputSource);if(mt===-1)return;let yt=C[mt];yt!==void 0&&(yt.update(tt.inputSource,tt.frame,c||o),yt.dispatchEvent({type:tt.type,data:tt.inputSource}))}function V(){s.removeEventListener("select",q),s.removeEventListener("selectstart",q),s.removeEventListener("selectend",q),s.removeEventListener("squeeze",q),s.removeEventListener("squeezestart",q),s.removeEventListener("squeezeend",q),s.removeEventListener("end",V),s.removeEventListener("inputsourceschange",lt);for(let tt=0;tt<C.length;tt++){let mt=A[tt];mt!==null&&(A[tt]=null,C[tt].disconnect(mt))}N=null,W=null,m.reset();for(let tt in g)delete g[tt];if(t.setRenderTarget(M),f=null,h=null,d=null,s=null,y=null,ut.stop(),n.isPresenting=!1,t.setPixelRatio(E),t.setSize(x.width,x.height,!1),F!==null){let tt=F.camera;tt.fov=F.fov,tt.zoom=F.zoom,tt.updateProjectionMatrix(),F=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(tt){r=tt,n.isPresenting===!0&&Yt("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(tt){a=tt,n.isPresenting===!0&&Yt("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(tt){c=tt},this.getBaseLayer=function(){return h!==null?h:f},this.getBinding=function(){return d===null&&v&&(d=new XRWebGLBinding(s,e)),d},this.getFrame=function(){return p},this.getSession=function(){return s},this.setSession=async function(tt){if(s=tt,s!==null){if(M=t.getRenderTarget(),s.addEventListener("select",q),s.addEventListener("selectstart",q),s.addEventListener("selectend",q),s.addEventListener("squeeze",q),s.addEventListener("squeezestart",q),s.addEventListener("squeezeend",q),s.addEventListener("end",V),s.addEventListener("inputsourceschange",lt),S.xrCompatible!==!0&&await e.makeXRCompatible(),E=t.getPixelRatio(),t.getSize(x),v&&"createProjectionLayer"in XRWebGLBinding.prototype){let yt=null,At=null,St=null;S.depth&&(St=S.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,yt=S.stencil?vs:gs,At=S.stencil?vr:ki);let Xt={colorFormat:e.RGBA8,depthFormat:St,scaleFactor:r};d=this.getBinding(),h=d.createProjectionLayer(Xt),s.updateRenderState({layers:[h]}),t.setPixelRatio(1),t.setSize(h.textureWidth,h.textureHeight,!1),y=new gi(h.textureWidth,h.textureHeight,{format:si,type:ai,depthTexture:new ys(h.textureWidth,h.textureHeight,At,void 0,void 0,void 0,void 0,void 0,void 0,yt),stencilBuffer:S.stencil,colorSpace:t.outputColorSpace,samples:S.antialias?4:0,resolveDepthBuffer:h.ignoreDepthValues===!1,resolveStencilBuffer:h.ignoreDepthValues===!1,storeMultisampledDepthBuffer:h.ignoreDepthValues===!1,storeMultisampledStencilBuffer:h.ignoreDepthValues===!1})}else{let yt={antialias:S.antialias,alpha:!0,depth:S.depth,stencil:S.stencil,framebufferScaleFactor:r};f=new XRWebGLLayer(s,e,yt),s.updateRenderState({baseLayer:f}),t.setPixelRatio(1),t.setSize(f.framebufferWidth,f.framebufferHeight,!1),y=new gi(f.framebufferWidth,f.framebufferHeight,{format:si,type:ai,colorSpace:t.outputColorSpace,stencilBuffer:S.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}y.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),ut.setContext(s),ut.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function lt(tt){for(let mt=0;mt<tt.removed.length;mt++){let yt=tt.removed[mt],At=A.indexOf(yt);At>=0&&(A[At]=null,C[At].disconnect(yt))}for(let mt=0;mt<tt.added.length;mt++){let yt=tt.added[mt],At=A.indexOf(yt);if(At===-1){for(let Xt=0;Xt<C.length;Xt++)if(Xt>=A.length){A.push(yt),At=Xt;break}else if(A[Xt]===null){A[Xt]=yt,At=Xt;break}if(At===-1)break}let St=C[At];St&&St.connect(yt)}}function Z(tt,mt){mt===null?tt.matrixWorld.copy(tt.matrix):tt.matrixWorld.multiplyMatrices(mt.matrixWorld,tt.matrix),tt.matrixWorldInverse.copy(tt.matrixWorld).invert()}this.updateCamera=function(tt){if(s===null)return;let mt=tt.near,yt=tt.far;m.texture!==null&&(m.depthNear>0&&(mt=m.depthNear),m.depthFar>0&&(yt=m.depthFar)),G.near=D.near=L.near=mt,G.far=D.far=L.far=yt,(N!==G.near||W!==G.far)&&(s.updateRenderState({depthNear:G.near,depthFar:G.far}),N=G.near,W=G.far),G.layers.mask=tt.layers.mask|6,L.layers.mask=G.layers.mask&-5,D.layers.mask=G.layers.mask&-3;let At=tt.parent,St=G.cameras;Z(G,At);for(let Xt=0;Xt<St.length;Xt++)Z(St[Xt],At);G.projectionMatrix.copy(L.projectionMatrix),G.projectionMatrixInverse.copy(L.projectionMatrixInverse),F===null&&tt.isPerspectiveCamera&&(F={camera:tt,fov:tt.fov,zoom:tt.zoom}),j(tt,G,At)};function j(tt,mt,yt){yt===null?tt.matrix.copy(mt.matrixWorld):(tt.matrix.copy(yt.matrixWorld),tt.matrix.invert(),tt.matrix.multiply(mt.matrixWorld)),tt.matrix.decompose(tt.position,tt.quaternion,tt.scale),tt.updateMatrixWorld(!0),tt.projectionMatrix.copy(mt.projectionMatrix),tt.projectionMatrixInverse.copy(mt.projectionMatrixInverse),tt.isPerspectiveCamera&&(tt.fov=ao*2*Math.atan(1/tt.projectionMatrix.elements[5]),tt.zoom=1)}this.getCamera=function(){return G},this.getFoveation=function(){if(!(h===null&&f===null))return l},this.setFoveation=function(tt){l=tt,h!==null&&(h.fixedFoveation=tt),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=tt)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh(G)},this.getCameraTexture=function(tt){return g[tt]};let et=null;function dt(tt,mt){if(u=mt.getViewerPose(c||o),p=mt,u!==null){let yt=u.views;f!==null&&(t.setRenderTargetFramebuffer(y,f.framebuffer),t.setRenderTarget(y));let At=!1;yt.length!==G.cameras.length&&(G.cameras.length=0,At=!0);for(let Gt=0;Gt<yt.length;Gt++){let ue=yt[Gt],le=null;if(f!==null)le=f.getViewport(ue);else{let Ke=d.getViewSubImage(h,ue);le=Ke.viewport,Gt===0&&(t.setRenderTargetTextures(y,Ke.colorTexture,Ke.depthStencilTexture),t.setRenderTarget(y))}let ie=B[Gt];ie===void 0&&(ie=new ti,ie.layers.enable(Gt),ie.viewport=new je,B[Gt]=ie),ie.matrix.fromArray(ue.transform.matrix),ie.matrix.decompose(ie.position,ie.quaternion,ie.scale),ie.projectionMatrix.fromArray(ue.projectionMatrix),ie.projectionMatrixInverse.copy(ie.projectionMatrix).invert(),ie.viewport.set(le.x,le.y,le.width,le.height),Gt===0&&(G.matrix.copy(ie.matrix),G.matrix.decompose(G.position,G.quaternion,G.scale)),At===!0&&G.cameras.push(ie)}let St=s.enabledFeatures;if(St&&St.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&v){d=n.getBinding();let Gt=d.getDepthInformation(yt[0]);Gt&&Gt.isValid&&Gt.texture&&m.init(Gt,s.renderState)}if(St&&St.includes("camera-access")&&v){t.state.unbindTexture(),d=n.getBinding();for(let Gt=0;Gt<yt.length;Gt++){let ue=yt[Gt].camera;if(ue){let le=g[ue];le||(le=new ya,g[ue]=le);let ie=d.getCameraImage(ue);le.sourceTexture=ie}}}}for(let yt=0;yt<C.length;yt++){let At=A[yt],St=C[yt];At!==null&&St!==void 0&&St.update(At,mt,c||o)}et&&et(tt,mt),mt.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:mt}),p=null}let ut=new Kg;ut.setAnimationLoop(dt),this.setAnimationLoop=function(tt){et=tt},this.dispose=function(){}}},fE=new Oe,o0=new ne;o0.set(-1,0,0,0,1,0,0,0,1);function pE(i,t){function e(m,g){m.matrixAutoUpdate===!0&&m.updateMatrix(),g.value.copy(m.matrix)}function n(m,g){g.color.getRGB(m.fogColor.value,Vd(i)),g.isFog?(m.fogNear.value=g.near,m.fogFar.value=g.far):g.isFogExp2&&(m.fogDensity.value=g.density)}function s(m,g,S,M,y){g.isNodeMaterial?g.uniformsNeedUpdate=!1:g.isMeshBasicMaterial?r(m,g):g.isMeshLambertMaterial?(r(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshToonMaterial?(r(m,g),d(m,g)):g.isMeshPhongMaterial?(r(m,g),u(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshStandardMaterial?(r(m,g),h(m,g),g.isMeshPhysicalMaterial&&f(m,g,y)):g.isMeshMatcapMaterial?(r(m,g),p(m,g)):g.isMeshDepthMaterial?r(m,g):g.isMeshDistanceMaterial?(r(m,g),v(m,g)):g.isMeshNormalMaterial?r(m,g):g.isLineBasicMaterial?(o(m,g),g.isLineDashedMaterial&&a(m,g)):g.isPointsMaterial?l(m,g,S,M):g.isSpriteMaterial?c(m,g):g.isShadowMaterial?(m.color.value.copy(g.color),m.opacity.value=g.opacity):g.isShaderMaterial&&(g.uniformsNeedUpdate=!1)}function r(m,g){m.opacity.value=g.opacity,g.color&&m.diffuse.value.copy(g.color),g.emissive&&m.emissive.value.copy(g.emissive).multiplyScalar(g.emissiveIntensity),g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.bumpMap&&(m.bumpMap.value=g.bumpMap,e(g.bumpMap,m.bumpMapTransform),m.bumpScale.value=g.bumpScale,g.side===ii&&(m.bumpScale.value*=-1)),g.normalMap&&(m.normalMap.value=g.normalMap,e(g.normalMap,m.normalMapTransform),m.normalScale.value.copy(g.normalScale),g.side===ii&&m.normalScale.value.negate()),g.displacementMap&&(m.displacementMap.value=g.displacementMap,e(g.displacementMap,m.displacementMapTransform),m.displacementScale.value=g.displacementScale,m.displacementBias.value=g.displacementBias),g.emissiveMap&&(m.emissiveMap.value=g.emissiveMap,e(g.emissiveMap,m.emissiveMapTransform)),g.specularMap&&(m.specularMap.value=g.specularMap,e(g.specularMap,m.specularMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest);let S=t.get(g),M=S.envMap,y=S.envMapRotation;M&&(m.envMap.value=M,m.envMapRotation.value.setFromMatrix4(fE.makeRotationFromEuler(y)).transpose(),M.isCubeTexture&&M.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(o0),m.reflectivity.value=g.reflectivity,m.ior.value=g.ior,m.refractionRatio.value=g.refractionRatio),g.lightMap&&(m.lightMap.value=g.lightMap,m.lightMapIntensity.value=g.lightMapIntensity,e(g.lightMap,m.lightMapTransform)),g.aoMap&&(m.aoMap.value=g.aoMap,m.aoMapIntensity.value=g.aoMapIntensity,e(g.aoMap,m.aoMapTransform))}function o(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform))}function a(m,g){m.dashSize.value=g.dashSize,m.totalSize.value=g.dashSize+g.gapSize,m.scale.value=g.scale}function l(m,g,S,M){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.size.value=g.size*S,m.scale.value=M*.5,g.map&&(m.map.value=g.map,e(g.map,m.uvTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function c(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.rotation.value=g.rotation,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function u(m,g){m.specular.value.copy(g.specular),m.shininess.value=Math.max(g.shininess,1e-4)}function d(m,g){g.gradientMap&&(m.gradientMap.value=g.gradientMap)}function h(m,g){m.metalness.value=g.metalness,g.metalnessMap&&(m.metalnessMap.value=g.metalnessMap,e(g.metalnessMap,m.metalnessMapTransform)),m.roughness.value=g.roughness,g.roughnessMap&&(m.roughnessMap.value=g.roughnessMap,e(g.roughnessMap,m.roughnessMapTransform)),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)}function f(m,g,S){m.ior.value=g.ior,g.diffuseRoughness>0&&(m.diffuseRoughness.value=g.diffuseRoughness,g.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=g.diffuseRoughnessMap,e(g.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),g.sheen>0&&(m.sheenColor.value.copy(g.sheenColor).multiplyScalar(g.sheen),m.sheenRoughness.value=g.sheenRoughness,g.sheenColorMap&&(m.sheenColorMap.value=g.sheenColorMap,e(g.sheenColorMap,m.sheenColorMapTransform)),g.sheenRoughnessMap&&(m.sheenRoughnessMap.value=g.sheenRoughnessMap,e(g.sheenRoughnessMap,m.sheenRoughnessMapTransform))),g.clearcoat>0&&(m.clearcoat.value=g.clearcoat,m.clearcoatRoughness.value=g.clearcoatRoughness,g.clearcoatMap&&(m.clearcoatMap.value=g.clearcoatMap,e(g.clearcoatMap,m.clearcoatMapTransform)),g.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=g.clearcoatRoughnessMap,e(g.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),g.clearcoatNormalMap&&(m.clearcoatNormalMap.value=g.clearcoatNormalMap,e(g.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(g.clearcoatNormalScale),g.side===ii&&m.clearcoatNormalScale.value.negate())),g.dispersion>0&&(m.dispersion.value=g.dispersion),g.retroreflectivity>0&&(m.retroreflectivity.value=g.retroreflectivity),g.iridescence>0&&(m.iridescence.value=g.iridescence,m.iridescenceIOR.value=g.iridescenceIOR,m.iridescenceThicknessMinimum.value=g.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=g.iridescenceThicknessMaximum,g.iridescenceMap&&(m.iridescenceMap.value=g.iridescenceMap,e(g.iridescenceMap,m.iridescenceMapTransform)),g.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=g.iridescenceThicknessMap,e(g.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),g.transmission>0&&(m.transmission.value=g.transmission,m.transmissionSamplerMap.value=S.texture,m.transmissionSamplerSize.value.set(S.width,S.height),g.transmissionMap&&(m.transmissionMap.value=g.transmissionMap,e(g.transmissionMap,m.transmissionMapTransform)),m.thickness.value=g.thickness,g.thicknessMap&&(m.thicknessMap.value=g.thicknessMap,e(g.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=g.attenuationDistance,m.attenuationColor.value.copy(g.attenuationColor)),g.anisotropy>0&&(m.anisotropyVector.value.set(g.anisotropy*Math.cos(g.anisotropyRotation),g.anisotropy*Math.sin(g.anisotropyRotation)),g.anisotropyMap&&(m.anisotropyMap.value=g.anisotropyMap,e(g.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=g.specularIntensity,m.specularColor.value.copy(g.specularColor),g.specularColorMap&&(m.specularColorMap.value=g.specularColorMap,e(g.specularColorMap,m.specularColorMapTransform)),g.specularIntensityMap&&(m.specularIntensityMap.value=g.specularIntensityMap,e(g.specularIntensityMap,m.specularIntensityMapTransform))}function p(m,g){g.matcap&&(m.matcap.value=g.matcap)}function v(m,g){let S=t.get(g).light;m.referencePosition.value.setFromMatrixPosition(S.matrixWorld),m.nearDistance.value=S.shadow.camera.near,m.farDistance.value=S.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function mE(i,t,e,n){let s={},r={};function o(S,M){let y=M.program;n.uniformBlockBinding(S,y,s[S.id])}function a(S,M){let y=s[S.id];y===void 0&&(p(S),y=l(S),s[S.id]=y,S.addEventListener("dispose",m));let C=M.program;n.updateUBOMapping(S,C);let A=t.render.frame;r[S.id]!==A&&(c(S),r[S.id]=A)}function l(S){let M=i.createBuffer(),y=S.__size,C=S.usage;return i.bindBuffer(i.UNIFORM_BUFFER,M),i.bufferData(i.UNIFORM_BUFFER,y,C),i.bindBuffer(i.UNIFORM_BUFFER,null),M}function c(S){let M=s[S.id],y=S.uniforms,C=S.__cache;i.bindBuffer(i.UNIFORM_BUFFER,M);for(let A=0,x=y.length;A<x;A++){let E=y[A];if(Array.isArray(E))for(let F=0,L=E.length;F<L;F++)u(E[F],A,F,C);else u(E,A,0,C)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function u(S,M,y,C){if(h(S,M,y,C)===!0){let A=S.__offset,x=S.value;if(Array.isArray(x)){let E=0;for(let F=0;F<x.length;F++){let L=x[F],D=v(L,!0);d(L,S.__data,E),E+=D.storage/Float32Array.BYTES_PER_ELEMENT}}else d(x,S.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,A,S.__data)}}function d(S,M,y){typeof S=="number"||typeof S=="boolean"?M[y]=S:S.isMatrix3?(M[y]=S.elements[0],M[y+1]=S.elements[1],M[y+2]=S.elements[2],M[y+3]=0,M[y+4]=S.elements[3],M[y+5]=S.elements[4],M[y+6]=S.elements[5],M[y+7]=0,M[y+8]=S.elements[6],M[y+9]=S.elements[7],M[y+10]=S.elements[8],M[y+11]=0):ArrayBuffer.isView(S)?M.set(S.subarray(0,M.length-y),y):S.toArray(M,y)}function h(S,M,y,C){let A=S.value,x=M+"_"+y;if(Array.isArray(A)){C[x]===void 0&&(C[x]=[]);let E=C[x],F=!1;for(let L=0;L<A.length;L++)f(A[L],E,L)===!0&&(F=!0);return F}return f(A,C,x)}function f(S,M,y){if(M[y]===void 0)return typeof S=="number"||typeof S=="boolean"?M[y]=S:ArrayBuffer.isView(S)?M[y]=S.slice():M[y]=S.clone(),!0;{let C=M[y];if(typeof S=="number"||typeof S=="boolean"){if(C!==S)return M[y]=S,!0}else{if(ArrayBuffer.isView(S))return!0;if(C.equals(S)===!1)return C.copy(S),!0}}return!1}function p(S){let M=S.uniforms,y=0,C=16;for(let x=0,E=M.length;x<E;x++){let F=Array.isArray(M[x])?M[x]:[M[x]];for(let L=0,D=F.length;L<D;L++){let B=F[L],G=Array.isArray(B.value)?B.value:[B.value],N=Array.isArray(M[x])||Array.isArray(B.value),W=y;for(let V=0,lt=G.length;V<lt;V++){let Z=G[V],j=v(Z,N),et=y%C,dt=et%j.boundary,ut=et+dt;y+=dt,ut!==0&&C-ut<j.storage&&(y+=C-ut),V===0&&(W=y),y+=j.storage}let q=B.type==="int"?Int32Array:B.type==="uint"?Uint32Array:Float32Array;B.__data=new q((y-W)/Float32Array.BYTES_PER_ELEMENT),B.__offset=W}}let A=y%C;return A>0&&(y+=C-A),S.__size=y,S.__cache={},this}function v(S,M){let y={boundary:0,storage:0};return typeof S=="number"||typeof S=="boolean"?(y.boundary=4,y.storage=4):S.isVector2?(y.boundary=8,y.storage=8):S.isVector3||S.isColor?(y.boundary=16,y.storage=12):S.isVector4?(y.boundary=16,y.storage=16):S.isMatrix3?(y.boundary=16,y.storage=48):S.isMatrix4?(y.boundary=16,y.storage=64):S.isTexture?Yt("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(S)?(y.boundary=16,y.storage=S.byteLength):Yt("WebGLRenderer: Unsupported uniform value type.",S),M===!0&&(y.boundary=16,y.storage=Math.ceil(y.storage/16)*16),y}function m(S){let M=S.target;M.removeEventListener("dispose",m),i.deleteBuffer(s[M.id]),delete s[M.id],delete r[M.id]}function g(){for(let S in s)i.deleteBuffer(s[S]);s={},r={}}return{bind:o,update:a,dispose:g}}var gE=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),ts=null;function _E(){return ts===null&&(ts=new Hs(gE,16,16,tr,Bi),ts.name="DFG_LUT",ts.minFilter=ei,ts.magFilter=ei,ts.wrapS=Ji,ts.wrapT=Ji,ts.generateMipmaps=!1,ts.needsUpdate=!0),ts}var _h=class{constructor(t={}){let{canvas:e=mg(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:u="default",failIfMajorPerformanceCaveat:d=!1,reversedDepthBuffer:h=!1,outputBufferType:f=ai}=t;this.isWebGLRenderer=!0;let p;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");p=n.getContextAttributes().alpha}else p=o;let v=f,m=new Set([Oc,Fc,Uc]),g=new Set([ai,ki,So,vr,Dc,Nc]),S=new Uint32Array(4),M=new Int32Array(4),y={textures:[],min:[],max:[],resolution:[]},C=null,A=null,x=[],E=[],F=null;this.domElement=e,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=Qi,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let L=this,D=!1,B=null,G=null,N=null,W=null;this._outputColorSpace=bn;let q=0,V=0,lt=null,Z=-1,j=null,et=new je,dt=new je,ut=null,tt=new Zt(0),mt=0,yt=e.width,At=e.height,St=1,Xt=null,re=null,Gt=new je(0,0,yt,At),ue=new je(0,0,yt,At),le=!1,ie=new Gs,Ke=new cc,He=!1,un=!1,Ne=new Oe,Rn=new H,xe=new je,xn={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},nn=!1;function dn(){return lt===null?St:1}let k=n;function Ct(R,z){return e.getContext(R,z)}let Kt,oe,Mt,Fe,Ht,qt,P,w,$,ht,ot,_t,xt,nt,st,pt,O,rt,it,wt,gt,bt,Wt;try{let R={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:u,failIfMajorPerformanceCaveat:d};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${"187"}`),e.addEventListener("webglcontextlost",kt,!1),e.addEventListener("webglcontextrestored",Qt,!1),e.addEventListener("webglcontextcreationerror",Rt,!1),k===null){let z="webgl2";if(k=Ct(z,R),k===null)throw Ct(z)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}jt()}catch(R){throw e.removeEventListener("webglcontextlost",kt,!1),e.removeEventListener("webglcontextrestored",Qt,!1),e.removeEventListener("webglcontextcreationerror",Rt,!1),te("WebGLRenderer: "+R.message),R}function jt(){Kt=new RM(k),Kt.init(),gt=new hE(k,Kt),oe=new _M(k,Kt,t,gt),Mt=new lE(k,Kt),oe.reversedDepthBuffer&&h&&Mt.buffers.depth.setReversed(!0),G=k.createFramebuffer(),N=k.createFramebuffer(),W=k.createFramebuffer(),Fe=new IM(k),Ht=new Yw,qt=new cE(k,Kt,Mt,Ht,oe,gt,Fe),P=new AM(L),w=new Dv(k),bt=new mM(k,w),$=new CM(k,w,Fe,bt),ht=new DM(k,$,w,bt,Fe),rt=new LM(k,oe,qt),st=new yM(Ht),ot=new qw(L,P,Kt,oe,bt,st),_t=new pE(L,Ht),xt=new Kw,nt=new nE(Kt),O=new pM(L,P,Mt,ht,p,l),pt=new aE(L,ht,oe),Wt=new mE(k,Fe,oe,Mt),it=new gM(k,Kt,Fe),wt=new PM(k,Kt,Fe),Fe.programs=ot.programs,L.capabilities=oe,L.extensions=Kt,L.properties=Ht,L.renderLists=xt,L.shadowMap=pt,L.state=Mt,L.info=Fe}v!==ai&&(F=new UM(v,e.width,e.height,a,s,r));let ct=new nf(L,k);this.xr=ct,this.getContext=function(){return k},this.getContextAttributes=function(){return k.getContextAttributes()},this.forceContextLoss=function(){let R=Kt.get("WEBGL_lose_context");R&&R.loseContext()},this.forceContextRestore=function(){let R=Kt.get("WEBGL_lose_context");R&&R.restoreContext()},this.getPixelRatio=function(){return St},this.setPixelRatio=function(R){R!==void 0&&(St=R,this.setSize(yt,At,!1))},this.getSize=function(R){return R.set(yt,At)},this.setSize=function(R,z,Q=!0){if(ct.isPresenting){Yt("WebGLRenderer: Can't change size while VR device is presenting.");return}yt=R,At=z,e.width=Math.floor(R*St),e.height=Math.floor(z*St),Q===!0&&(e.style.width=R+"px",e.style.height=z+"px"),F!==null&&F.setSize(e.width,e.height),this.setViewport(0,0,R,z)},this.getDrawingBufferSize=function(R){return R.set(yt*St,At*St).floor()},this.setDrawingBufferSize=function(R,z,Q){yt=R,At=z,St=Q,e.width=Math.floor(R*Q),e.height=Math.floor(z*Q),this.setViewport(0,0,R,z)},this.setEffects=function(R){if(v===ai){te("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(R){for(let z=0;z<R.length;z++)if(R[z].isOutputPass===!0){Yt("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}F.setEffects(R||[])},this.getCurrentViewport=function(R){return R.copy(et)},this.getViewport=function(R){return R.copy(Gt)},this.setViewport=function(R,z,Q,Y){R.isVector4?Gt.set(R.x,R.y,R.z,R.w):Gt.set(R,z,Q,Y),Mt.viewport(et.copy(Gt).multiplyScalar(dn()).round())},this.getScissor=function(R){return R.copy(ue)},this.setScissor=function(R,z,Q,Y){R.isVector4?ue.set(R.x,R.y,R.z,R.w):ue.set(R,z,Q,Y),Mt.scissor(dt.copy(ue).multiplyScalar(dn()).round())},this.getScissorTest=function(){return le},this.setScissorTest=function(R){Mt.setScissorTest(le=R)},this.setOpaqueSort=function(R){Xt=R},this.setTransparentSort=function(R){re=R},this.getClearColor=function(R){return R.copy(O.getClearColor())},this.setClearColor=function(){O.setClearColor(...arguments)},this.getClearAlpha=function(){return O.getClearAlpha()},this.setClearAlpha=function(){O.setClearAlpha(...arguments)},this.clear=function(R=!0,z=!0,Q=!0){let Y=0;if(R){let K=!1;if(lt!==null){let Et=lt.texture.format;K=m.has(Et)}if(K){let Et=lt.texture.type,Pt=g.has(Et),Tt=O.getClearColor(),Lt=O.getClearAlpha(),zt=Tt.r,ee=Tt.g,de=Tt.b;Pt?(S[0]=zt,S[1]=ee,S[2]=de,S[3]=Lt,k.clearBufferuiv(k.COLOR,0,S)):(M[0]=zt,M[1]=ee,M[2]=de,M[3]=Lt,k.clearBufferiv(k.COLOR,0,M))}else Y|=k.COLOR_BUFFER_BIT}z&&(Y|=k.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),Q&&(Y|=k.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),Y!==0&&k.clear(Y)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(R){R.setRenderer(this),B=R},this.dispose=function(){e.removeEventListener("webglcontextlost",kt,!1),e.removeEventListener("webglcontextrestored",Qt,!1),e.removeEventListener("webglcontextcreationerror",Rt,!1),O.dispose(),xt.dispose(),nt.dispose(),qt.dispose(),Ht.dispose(),P.dispose(),ht.dispose(),$.dispose(),bt.dispose(),Wt.dispose(),ot.dispose(),ct.dispose(),ct.removeEventListener("sessionstart",sl),ct.removeEventListener("sessionend",Vi),ss.stop()};function kt(R){R.preventDefault(),Bd("WebGLRenderer: Context Lost."),D=!0}function Qt(){Bd("WebGLRenderer: Context Restored."),D=!1;let R=Fe.autoReset,z=pt.enabled,Q=pt.autoUpdate,Y=pt.needsUpdate,K=pt.type;jt(),Fe.autoReset=R,pt.enabled=z,pt.autoUpdate=Q,pt.needsUpdate=Y,pt.type=K}function Rt(R){te("WebGLRenderer: A WebGL context could not be created. Reason: ",R.statusMessage)}function ae(R){let z=R.target;z.removeEventListener("dispose",ae),We(z)}function We(R){Yn(R),Ht.remove(R)}function Yn(R){let z=Ht.get(R).programs;z!==void 0&&(z.forEach(function(Q){ot.releaseProgram(Q)}),R.isShaderMaterial&&ot.releaseShaderCache(R))}this.renderBufferDirect=function(R,z,Q,Y,K,Et){z===null&&(z=xn);let Pt=K.isMesh&&K.matrixWorld.determinantAffine()<0,Tt=Go(R,z,Q,Y,K);Mt.setMaterial(Y,Pt);let Lt=Q.index,zt=1;if(Y.wireframe===!0){if(Lt=$.getWireframeAttribute(Q),Lt===void 0)return;zt=2}let ee=Q.drawRange,de=Q.attributes.position,Bt=ee.start*zt,fe=(ee.start+ee.count)*zt;Et!==null&&(Bt=Math.max(Bt,Et.start*zt),fe=Math.min(fe,(Et.start+Et.count)*zt)),Lt!==null?(Bt=Math.max(Bt,0),fe=Math.min(fe,Lt.count)):de!=null&&(Bt=Math.max(Bt,0),fe=Math.min(fe,de.count));let Qe=fe-Bt;if(Qe<0||Qe===1/0)return;bt.setup(K,Y,Tt,Q,Lt);let Pe,Ie=it;if(Lt!==null&&(Pe=w.get(Lt),Ie=wt,Ie.setIndex(Pe)),K.isMesh)Y.wireframe===!0?(Mt.setLineWidth(Y.wireframeLinewidth*dn()),Ie.setMode(k.LINES)):Ie.setMode(k.TRIANGLES);else if(K.isLine){let vn=Y.linewidth;vn===void 0&&(vn=1),Mt.setLineWidth(vn*dn()),K.isLineSegments?Ie.setMode(k.LINES):K.isLineLoop?Ie.setMode(k.LINE_LOOP):Ie.setMode(k.LINE_STRIP)}else K.isPoints?Ie.setMode(k.POINTS):K.isSprite&&Ie.setMode(k.TRIANGLES);if(K.isBatchedMesh)if(Kt.get("WEBGL_multi_draw"))Ie.renderMultiDraw(K._multiDrawStarts,K._multiDrawCounts,K._multiDrawCount);else{let vn=K._multiDrawStarts,Ft=K._multiDrawCounts,fn=K._multiDrawCount,ge=Lt?w.get(Lt).bytesPerElement:1,os=Ht.get(Y).currentProgram.getUniforms();for(let pn=0;pn<fn;pn++)os.setValue(k,"_gl_DrawID",pn),Ie.render(vn[pn]/ge,Ft[pn])}else if(K.isInstancedMesh)Ie.renderInstances(Bt,Qe,K.count);else if(Q.isInstancedBufferGeometry){let vn=Q._maxInstanceCount!==void 0?Q._maxInstanceCount:1/0,Ft=Math.min(Q.instanceCount,vn);Ie.renderInstances(Bt,Qe,Ft)}else Ie.render(Bt,Qe)};function Bo(R,z,Q,Y){B!==null&&R.isNodeMaterial&&B.setObject(Y,R),He===!0&&st.setState(R,Q,!1),R.transparent===!0&&R.side===$n&&R.forceSinglePass===!1?(R.side=ii,R.needsUpdate=!0,Wi(R,z,Y),R.side=Qs,R.needsUpdate=!0,Wi(R,z,Y),R.side=$n):Wi(R,z,Y)}this.compile=function(R,z,Q=null){Q===null&&(Q=R),B!==null&&B.renderStart(R,z,Q),A=nt.get(Q),A.init(z),E.push(A),Q.traverseVisible(function(K){K.isLight&&K.layers.test(z.layers)&&(A.pushLight(K),K.castShadow&&A.pushShadow(K))}),R!==Q&&R.traverseVisible(function(K){K.isLight&&K.layers.test(z.layers)&&(A.pushLight(K),K.castShadow&&A.pushShadow(K))}),A.setupLights(),B!==null&&B.updateLights(A.state.lightsArray),un=this.localClippingEnabled,He=st.init(this.clippingPlanes,un),He===!0&&st.setGlobalState(this.clippingPlanes,z),B!==null&&pt.render(A.state.shadowsArray,Q,z);let Y=new Set;return R.traverse(function(K){if(!(K.isMesh||K.isPoints||K.isLine||K.isSprite))return;let Et=K.material;if(Et)if(Array.isArray(Et))for(let Pt=0;Pt<Et.length;Pt++){let Tt=Et[Pt];Bo(Tt,Q,z,K),Y.add(Tt)}else Bo(Et,Q,z,K),Y.add(Et)}),A=E.pop(),B!==null&&B.renderEnd(),Y},this.compileAsync=function(R,z,Q=null){let Y=this.compile(R,z,Q);return new Promise(K=>{function Et(){if(Y.forEach(function(Pt){let Lt=Ht.get(Pt).currentProgram;(Lt===void 0||Lt.isReady())&&Y.delete(Pt)}),Y.size===0){K(R);return}setTimeout(Et,10)}Kt.get("KHR_parallel_shader_compile")!==null?Et():setTimeout(Et,10)})};let Pr=null;function hu(R){Pr&&Pr(R)}function sl(){ss.stop()}function Vi(){ss.start()}let ss=new Kg;ss.setAnimationLoop(hu),typeof self<"u"&&ss.setContext(self),this.setAnimationLoop=function(R){Pr=R,ct.setAnimationLoop(R),R===null?ss.stop():ss.start()},ct.addEventListener("sessionstart",sl),ct.addEventListener("sessionend",Vi),this.render=function(R,z){if(z!==void 0&&z.isCamera!==!0){te("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(D===!0)return;B!==null&&B.renderStart(R,z);let Q=ct.enabled===!0&&ct.isPresenting===!0,Y=F!==null&&(lt===null||Q)&&F.begin(L,lt);if(R.matrixWorldAutoUpdate===!0&&R.updateMatrixWorld(),z.parent===null&&z.matrixWorldAutoUpdate===!0&&z.updateMatrixWorld(),ct.enabled===!0&&ct.isPresenting===!0&&(F===null||F.isCompositing()===!1)&&(ct.cameraAutoUpdate===!0&&ct.updateCamera(z),z=ct.getCamera()),R.isScene===!0&&R.onBeforeRender(L,R,z,lt),A=nt.get(R,E.length),A.init(z),A.state.textureUnits=qt.getTextureUnits(),E.push(A),Ne.multiplyMatrices(z.projectionMatrix,z.matrixWorldInverse),z.isArrayCamera?Ke.setFromArrayCamera(z):ie.setFromProjectionMatrix(Ne,Ei,z.reversedDepth),un=this.localClippingEnabled,He=st.init(this.clippingPlanes,un),C=xt.get(R,x.length),C.init(),x.push(C),this.info.render.frame++,ct.enabled===!0&&ct.isPresenting===!0){let Pt=L.xr.getDepthSensingMesh();Pt!==null&&rs(Pt,z,-1/0,L.sortObjects)}rs(R,z,0,L.sortObjects),C.finish(),B!==null&&B.updateLights(A.state.lightsArray),L.sortObjects===!0&&C.sort(Xt,re),nn=ct.enabled===!1||ct.isPresenting===!1||ct.hasDepthSensing()===!1,nn&&O.addToRenderList(C,R),this.info.autoReset===!0&&this.info.reset(),He===!0&&st.beginShadows();let K=A.state.shadowsArray;if(pt.render(K,R,z),He===!0&&st.endShadows(),(Y&&F.hasRenderPass())===!1){let Pt=C.opaque,Tt=C.transmissive;if(A.setupLights(),z.isArrayCamera){let Lt=z.cameras;if(Tt.length>0)for(let zt=0,ee=Lt.length;zt<ee;zt++){let de=Lt[zt];Ci(Pt,Tt,R,de)}nn&&O.render(R);for(let zt=0,ee=Lt.length;zt<ee;zt++){let de=Lt[zt];zo(C,R,de,de.viewport)}}else Tt.length>0&&Ci(Pt,Tt,R,z),nn&&O.render(R),zo(C,R,z)}lt!==null&&V===0&&(qt.updateMultisampleRenderTarget(lt),qt.updateRenderTargetMipmap(lt)),Y&&F.end(L),R.isScene===!0&&R.onAfterRender(L,R,z),bt.resetDefaultState(),Z=-1,j=null,E.pop(),E.length>0?(A=E[E.length-1],qt.setTextureUnits(A.state.textureUnits),He===!0&&st.setGlobalState(L.clippingPlanes,A.state.camera)):A=null,x.pop(),x.length>0?C=x[x.length-1]:C=null,B!==null&&B.renderEnd()};function rs(R,z,Q,Y){if(R.visible===!1)return;if(R.layers.test(z.layers)){if(R.isGroup)Q=R.renderOrder;else if(R.isLOD)R.autoUpdate===!0&&R.update(z);else if(R.isLight)A.pushLight(R),R.castShadow&&A.pushShadow(R);else if(R.isSprite){let Pt=z.isArrayCamera?Ke:ie;if(!R.frustumCulled||R.intersectsFrustum(Pt)){Y&&xe.setFromMatrixPosition(R.matrixWorld).applyMatrix4(Ne);let Tt=ht.update(R),Lt=R.material;Lt.visible&&C.push(R,Tt,Lt,Q,xe.z,null,z)}}else if(R.isMesh||R.isLine||R.isPoints){let Pt=z.isArrayCamera?Ke:ie;if(!R.frustumCulled||R.intersectsFrustum(Pt)){let Tt=ht.update(R),Lt=R.material;if(Y&&(R.boundingSphere!==void 0?(R.boundingSphere===null&&R.computeBoundingSphere(),xe.copy(R.boundingSphere.center)):(Tt.boundingSphere===null&&Tt.computeBoundingSphere(),xe.copy(Tt.boundingSphere.center)),xe.applyMatrix4(R.matrixWorld).applyMatrix4(Ne)),Array.isArray(Lt)){let zt=Tt.groups;for(let ee=0,de=zt.length;ee<de;ee++){let Bt=zt[ee],fe=Lt[Bt.materialIndex];fe&&fe.visible&&C.push(R,Tt,fe,Q,xe.z,Bt,z)}}else Lt.visible&&C.push(R,Tt,Lt,Q,xe.z,null,z)}}}let Et=R.children;for(let Pt=0,Tt=Et.length;Pt<Tt;Pt++)rs(Et[Pt],z,Q,Y)}function zo(R,z,Q,Y){let{opaque:K,transmissive:Et,transparent:Pt}=R;A.setupLightsView(Q),He===!0&&st.setGlobalState(L.clippingPlanes,Q),Y&&Mt.viewport(et.copy(Y)),K.length>0&&sn(K,z,Q),Et.length>0&&sn(Et,z,Q),Pt.length>0&&sn(Pt,z,Q),Mt.buffers.depth.setTest(!0),Mt.buffers.depth.setMask(!0),Mt.buffers.color.setMask(!0),Mt.setPolygonOffset(!1)}function Ci(R,z,Q,Y){if((Q.isScene===!0?Q.overrideMaterial:null)!==null)return;if(A.state.transmissionRenderTarget[Y.id]===void 0){let Bt=Kt.has("EXT_color_buffer_half_float")||Kt.has("EXT_color_buffer_float");A.state.transmissionRenderTarget[Y.id]=new gi(1,1,{generateMipmaps:!0,type:Bt?Bi:ai,minFilter:xs,samples:Math.max(4,oe.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:_e.workingColorSpace})}let Et=A.state.transmissionRenderTarget[Y.id],Pt=Y.viewport||et;Et.setSize(Pt.z*L.transmissionResolutionScale,Pt.w*L.transmissionResolutionScale);let Tt=L.getRenderTarget(),Lt=L.getActiveCubeFace(),zt=L.getActiveMipmapLevel();L.setRenderTarget(Et),L.getClearColor(tt),mt=L.getClearAlpha(),mt<1&&L.setClearColor(16777215,.5),L.clear(),nn&&O.render(Q);let ee=L.toneMapping;L.toneMapping=Qi;let de=Y.viewport;if(Y.viewport!==void 0&&(Y.viewport=void 0),A.setupLightsView(Y),He===!0&&st.setGlobalState(L.clippingPlanes,Y),sn(R,Q,Y),qt.updateMultisampleRenderTarget(Et),qt.updateRenderTargetMipmap(Et),Kt.has("WEBGL_multisampled_render_to_texture")===!1){let Bt=!1;for(let fe=0,Qe=z.length;fe<Qe;fe++){let Pe=z[fe],{object:Ie,geometry:vn,material:Ft,group:fn}=Pe;if(Ft.side===$n&&Ie.layers.test(Y.layers)){let ge=Ft.side;Ft.side=ii,Ft.needsUpdate=!0,cn(Ie,Q,Y,vn,Ft,fn),Ft.side=ge,Ft.needsUpdate=!0,Bt=!0}}Bt===!0&&(qt.updateMultisampleRenderTarget(Et),qt.updateRenderTargetMipmap(Et))}L.setRenderTarget(Tt,Lt,zt),L.setClearColor(tt,mt),de!==void 0&&(Y.viewport=de),L.toneMapping=ee}function sn(R,z,Q){let Y=z.isScene===!0?z.overrideMaterial:null;for(let K=0,Et=R.length;K<Et;K++){let Pt=R[K],{object:Tt,geometry:Lt,group:zt}=Pt,ee=Pt.material;ee.allowOverride===!0&&Y!==null&&(ee=Y),Tt.layers.test(Q.layers)&&cn(Tt,z,Q,Lt,ee,zt)}}function cn(R,z,Q,Y,K,Et){B!==null&&K.isNodeMaterial&&B.setObject(R,K),R.onBeforeRender(L,z,Q,Y,K,Et),R.modelViewMatrix.multiplyMatrices(Q.matrixWorldInverse,R.matrixWorld),R.normalMatrix.getNormalMatrix(R.modelViewMatrix),K.onBeforeRender(L,z,Q,Y,R,Et),K.transparent===!0&&K.side===$n&&K.forceSinglePass===!1?(K.side=ii,K.needsUpdate=!0,L.renderBufferDirect(Q,z,Y,K,R,Et),K.side=Qs,K.needsUpdate=!0,L.renderBufferDirect(Q,z,Y,K,R,Et),K.side=$n):L.renderBufferDirect(Q,z,Y,K,R,Et),R.onAfterRender(L,z,Q,Y,K,Et)}function hn(R){let z=0;for(let Q of R)Q.texture!==null&&z++;return z}function Wi(R,z,Q){z.isScene!==!0&&(z=xn);let Y=Ht.get(R),K=A.state.lights,Et=A.state.shadowsArray,Pt=K.state.version,Tt=ot.getParameters(R,K.state,Et,z,Q,A.state.lightProbeGridArray),Lt=ot.getProgramCacheKey(Tt),zt=Y.programs;Y.environment=R.isMeshStandardMaterial||R.isMeshLambertMaterial||R.isMeshPhongMaterial?z.environment:null,Y.fog=z.fog;let ee=R.isMeshStandardMaterial||R.isMeshLambertMaterial&&!R.envMap||R.isMeshPhongMaterial&&!R.envMap;Y.envMap=P.get(R.envMap||Y.environment,ee),Y.envMapRotation=Y.environment!==null&&R.envMap===null?z.environmentRotation:R.envMapRotation,zt===void 0&&(R.addEventListener("dispose",ae),zt=new Map,Y.programs=zt,Y.programVariants=new Map);let de=zt.get(Lt);if(de!==void 0){if(Y.currentProgram===de&&Y.lightsStateVersion===Pt)return Ho(R,Tt),de}else Tt.uniforms=ot.getUniforms(R),B!==null&&R.isNodeMaterial&&B.build(R,Q,Tt),R.onBeforeCompile(Tt,L),de=ot.acquireProgram(Tt,Lt),zt.set(Lt,de),Y.uniforms=Tt.uniforms;let Bt=Y.uniforms;return(!R.isShaderMaterial&&!R.isRawShaderMaterial||R.clipping===!0)&&(Bt.clippingPlanes=st.uniform),Ho(R,Tt),Y.needsLights=Es(R),Y.lightsStateVersion=Pt,Y.needsLights&&(Bt.ambientLightColor.value=K.state.ambient,Bt.lightProbe.value=K.state.probe,Bt.sunLights.value=K.state.sun,Bt.sunLightShadows.value=K.state.sunShadow,Bt.directionalLights.value=K.state.directional,Bt.directionalLightShadows.value=K.state.directionalShadow,Bt.spotLights.value=K.state.spot,Bt.spotLightShadows.value=K.state.spotShadow,Bt.rectAreaLights.value=K.state.rectArea,Bt.ltc_1.value=K.state.rectAreaLTC1,Bt.ltc_2.value=K.state.rectAreaLTC2,Bt.pointLights.value=K.state.point,Bt.pointLightShadows.value=K.state.pointShadow,Bt.hemisphereLights.value=K.state.hemi,Bt.sunShadowMatrix.value=K.state.sunShadowMatrix,Bt.sunShadowCascade.value=K.state.sunShadowCascade,Bt.directionalShadowMatrix.value=K.state.directionalShadowMatrix,Bt.spotLightMatrix.value=K.state.spotLightMatrix,Bt.spotLightMap.value=K.state.spotLightMap,Bt.pointShadowMatrix.value=K.state.pointShadowMatrix),Y.numLightProbeGrids=hn(A.state.lightProbeGridArray),Y.currentProgram=de,Y.uniformsList=null,de}function hi(R,z,Q,Y,K){let Et=Ht.get(R),Pt=Et.currentProgram.id+","+Y+","+K,Tt=Et.programVariants.get(Pt);return Tt===void 0?(Tt=Wi(R,z,Q),Et.programVariants.set(Pt,Tt)):(Et.currentProgram=Tt,Et.uniformsList=null,Et.outputColorSpace=Y,Et.toneMapping=K),Tt}function ws(R){if(R.uniformsList===null){let z=R.currentProgram.getUniforms();R.uniformsList=Eo.seqWithValue(z.seq,R.uniforms)}return R.uniformsList}function Ho(R,z){let Q=Ht.get(R);Q.outputColorSpace=z.outputColorSpace,Q.batching=z.batching,Q.batchingColor=z.batchingColor,Q.instancing=z.instancing,Q.instancingColor=z.instancingColor,Q.instancingMorph=z.instancingMorph,Q.skinning=z.skinning,Q.morphTargets=z.morphTargets,Q.morphNormals=z.morphNormals,Q.morphColors=z.morphColors,Q.morphTargetsCount=z.morphTargetsCount,Q.numClippingPlanes=z.numClippingPlanes,Q.numIntersection=z.numClipIntersection,Q.vertexAlphas=z.vertexAlphas,Q.vertexTangents=z.vertexTangents,Q.toneMapping=z.toneMapping}function Go(R,z,Q,Y,K){z.isScene!==!0&&(z=xn),qt.resetTextureUnits();let Et=z.fog,Pt=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial?z.environment:null,Tt=lt===null?L.outputColorSpace:lt.isXRRenderTarget===!0?lt.texture.colorSpace:_e.workingColorSpace,Lt=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial&&!Y.envMap||Y.isMeshPhongMaterial&&!Y.envMap,zt=P.get(Y.envMap||Pt,Lt),ee=Y.vertexColors===!0&&!!Q.attributes.color&&Q.attributes.color.itemSize===4,de=!!Q.attributes.tangent&&(!!Y.normalMap||Y.anisotropy>0),Bt=!!Q.morphAttributes.position,fe=!!Q.morphAttributes.normal,Qe=!!Q.morphAttributes.color,Pe=Qi;Y.toneMapped&&(lt===null||lt.isXRRenderTarget===!0)&&(Pe=L.toneMapping);let Ie=Q.morphAttributes.position||Q.morphAttributes.normal||Q.morphAttributes.color,vn=Ie!==void 0?Ie.length:0,Ft=Ht.get(Y),fn=A.state.lights;if(He===!0&&(un===!0||R!==j)){let Le=R===j&&Y.id===Z;st.setState(Y,R,Le)}let ge=!1,os=!1;Y.version===Ft.__version?Ft.needsLights&&Ft.lightsStateVersion!==fn.state.version||K.isBatchedMesh&&Ft.batching===!1||!K.isBatchedMesh&&Ft.batching===!0||K.isBatchedMesh&&Ft.batchingColor===!0&&K._colorsTexture===null||K.isBatchedMesh&&Ft.batchingColor===!1&&K._colorsTexture!==null||K.isInstancedMesh&&Ft.instancing===!1||!K.isInstancedMesh&&Ft.instancing===!0||K.isSkinnedMesh&&Ft.skinning===!1||!K.isSkinnedMesh&&Ft.skinning===!0||K.isInstancedMesh&&Ft.instancingColor===!0&&K.instanceColor===null||K.isInstancedMesh&&Ft.instancingColor===!1&&K.instanceColor!==null||K.isInstancedMesh&&Ft.instancingMorph===!0&&K.morphTexture===null||K.isInstancedMesh&&Ft.instancingMorph===!1&&K.morphTexture!==null||Ft.envMap!==zt||Y.fog===!0&&Ft.fog!==Et||Ft.numClippingPlanes!==void 0&&(Ft.numClippingPlanes!==st.numPlanes||Ft.numIntersection!==st.numIntersection)||Ft.vertexAlphas!==ee||Ft.vertexTangents!==de||Ft.morphTargets!==Bt||Ft.morphNormals!==fe||Ft.morphColors!==Qe||Ft.morphTargetsCount!==vn||Ft.numLightProbeGrids!==hn(A.state.lightProbeGridArray)?ge=!0:(Ft.outputColorSpace!==Tt||Ft.toneMapping!==Pe)&&(os=!0):(ge=!0,Ft.__version=Y.version);let pn=Ft.currentProgram;(ge===!0||os===!0)&&(pn=os===!0?hi(Y,z,K,Tt,Pe):Wi(Y,z,K),B&&Y.isNodeMaterial&&B.onUpdateProgram(Y,pn,Ft));let Dr=!1,Xi=!1,as=!1,ce=pn.getUniforms(),rn=Ft.uniforms;if(Mt.useProgram(pn.program)&&(Dr=!0,Xi=!0,as=!0),Y.id!==Z&&(Z=Y.id,Xi=!0),Dr||j!==R){Mt.buffers.depth.getReversed()&&R.reversedDepth!==!0&&(R._reversedDepth=!0,R.updateProjectionMatrix()),ce.setValue(k,"projectionMatrix",R.projectionMatrix),ce.setValue(k,"viewMatrix",R.matrixWorldInverse);let mn=ce.map.cameraPosition;mn!==void 0&&mn.setValue(k,Rn.setFromMatrixPosition(R.matrixWorld)),oe.logarithmicDepthBuffer&&ce.setValue(k,"logDepthBufFC",2/(Math.log(R.far+1)/Math.LN2)),(Y.isMeshPhongMaterial||Y.isMeshToonMaterial||Y.isMeshLambertMaterial||Y.isMeshBasicMaterial||Y.isMeshStandardMaterial||Y.isShaderMaterial)&&ce.setValue(k,"isOrthographic",R.isOrthographicCamera===!0),j!==R&&(j=R,Xi=!0,as=!0)}if(Ft.needsLights&&(fn.state.sunShadowMap.length>0&&ce.setValue(k,"sunShadowMap",fn.state.sunShadowMap,qt),fn.state.directionalShadowMap.length>0&&ce.setValue(k,"directionalShadowMap",fn.state.directionalShadowMap,qt),fn.state.spotShadowMap.length>0&&ce.setValue(k,"spotShadowMap",fn.state.spotShadowMap,qt),fn.state.pointShadowMap.length>0&&ce.setValue(k,"pointShadowMap",fn.state.pointShadowMap,qt)),K.isSkinnedMesh){ce.setOptional(k,K,"bindMatrix"),ce.setOptional(k,K,"bindMatrixInverse");let Le=K.skeleton;Le&&(Le.boneTexture===null&&Le.computeBoneTexture(),ce.setValue(k,"boneTexture",Le.boneTexture,qt))}K.isBatchedMesh&&(ce.setOptional(k,K,"batchingTexture"),ce.setValue(k,"batchingTexture",K._matricesTexture,qt),ce.setOptional(k,K,"batchingIdTexture"),ce.setValue(k,"batchingIdTexture",K._indirectTexture,qt),ce.setOptional(k,K,"batchingColorTexture"),K._colorsTexture!==null&&ce.setValue(k,"batchingColorTexture",K._colorsTexture,qt));let Zn=Q.morphAttributes;if((Zn.position!==void 0||Zn.normal!==void 0||Zn.color!==void 0)&&rt.update(K,Q,pn),(Xi||Ft.receiveShadow!==K.receiveShadow)&&(Ft.receiveShadow=K.receiveShadow,ce.setValue(k,"receiveShadow",K.receiveShadow)),(Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial)&&Y.envMap===null&&z.environment!==null&&(rn.envMapIntensity.value=z.environmentIntensity),rn.dfgLUT!==void 0&&(rn.dfgLUT.value=_E()),Xi){if(ce.setValue(k,"toneMappingExposure",L.toneMappingExposure),Ft.needsLights&&Ir(rn,as),Et&&Y.fog===!0&&_t.refreshFogUniforms(rn,Et),_t.refreshMaterialUniforms(rn,Y,St,At,A.state.transmissionRenderTarget[R.id]),Ft.needsLights&&Ft.numLightProbeGrids>0){let Le=y,mn=0;for(let Gn of A.state.lightProbeGridArray)Gn.texture!==null&&(Le.textures[mn]=Gn.texture,Le.min[mn]=Gn.boundingBox.min,Le.max[mn]=Gn.boundingBox.max,Le.resolution[mn]=Gn.resolution,mn++);for(let Gn in Le)Le[Gn].length=mn;rn.probesSH.value=Le.textures,rn.probesMin.value=Le.min,rn.probesMax.value=Le.max,rn.probesResolution.value=Le.resolution}Eo.upload(k,ws(Ft),rn,qt)}if(Y.isShaderMaterial&&Y.uniformsNeedUpdate===!0&&(Eo.upload(k,ws(Ft),rn,qt),Y.uniformsNeedUpdate=!1),Y.isSpriteMaterial&&ce.setValue(k,"center",K.center),ce.setValue(k,"modelViewMatrix",K.modelViewMatrix),ce.setValue(k,"normalMatrix",K.normalMatrix),ce.setValue(k,"modelMatrix",K.matrixWorld),Y.uniformsGroups!==void 0){let Le=Y.uniformsGroups;for(let mn=0,Gn=Le.length;mn<Gn;mn++){let rl=Le[mn];Wt.update(rl,pn),Wt.bind(rl,pn)}}return pn}function Ir(R,z){R.ambientLightColor.needsUpdate=z,R.lightProbe.needsUpdate=z,R.sunLights.needsUpdate=z,R.sunLightShadows.needsUpdate=z,R.directionalLights.needsUpdate=z,R.directionalLightShadows.needsUpdate=z,R.pointLights.needsUpdate=z,R.pointLightShadows.needsUpdate=z,R.spotLights.needsUpdate=z,R.spotLightShadows.needsUpdate=z,R.rectAreaLights.needsUpdate=z,R.hemisphereLights.needsUpdate=z}function Es(R){return R.isMeshLambertMaterial||R.isMeshToonMaterial||R.isMeshPhongMaterial||R.isMeshStandardMaterial||R.isShadowMaterial||R.isShaderMaterial&&R.lights===!0}this.getActiveCubeFace=function(){return q},this.getActiveMipmapLevel=function(){return V},this.getRenderTarget=function(){return lt},this.setRenderTargetTextures=function(R,z,Q){let Y=Ht.get(R);Y.__autoAllocateDepthBuffer=R.resolveDepthBuffer===!1,Y.__autoAllocateDepthBuffer===!1&&(Y.__useRenderToTexture=!1),Ht.get(R.texture).__webglTexture=z,Ht.get(R.depthTexture).__webglTexture=Y.__autoAllocateDepthBuffer?void 0:Q,Y.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(R,z){let Q=Ht.get(R);Q.__webglFramebuffer=z,Q.__useDefaultFramebuffer=z===void 0},this.setRenderTarget=function(R,z=0,Q=0){lt=R,q=z,V=Q;let Y=null,K=!1,Et=!1;if(R){let Tt=Ht.get(R);if(Tt.__useDefaultFramebuffer!==void 0){Mt.bindFramebuffer(k.FRAMEBUFFER,Tt.__webglFramebuffer),et.copy(R.viewport),dt.copy(R.scissor),ut=R.scissorTest,Mt.viewport(et),Mt.scissor(dt),Mt.setScissorTest(ut),Z=-1;return}else if(Tt.__webglFramebuffer===void 0)qt.setupRenderTarget(R);else if(Tt.__hasExternalTextures)qt.rebindTextures(R,Ht.get(R.texture).__webglTexture,Ht.get(R.depthTexture).__webglTexture);else if(R.depthBuffer){let ee=R.depthTexture;if(Tt.__boundDepthTexture!==ee){if(ee!==null&&Ht.has(ee)&&(R.width!==ee.image.width||R.height!==ee.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");qt.setupDepthRenderbuffer(R)}}let Lt=R.texture;(Lt.isData3DTexture||Lt.isDataArrayTexture||Lt.isCompressedArrayTexture)&&(Et=!0);let zt=Ht.get(R).__webglFramebuffer;R.isWebGLCubeRenderTarget?(Array.isArray(zt[z])?Y=zt[z][Q]:Y=zt[z],K=!0):R.samples>0&&qt.useMultisampledRTT(R)===!1?Y=Ht.get(R).__webglMultisampledFramebuffer:Array.isArray(zt)?Y=zt[Q]:Y=zt,et.copy(R.viewport),dt.copy(R.scissor),ut=R.scissorTest}else et.copy(Gt).multiplyScalar(St).floor(),dt.copy(ue).multiplyScalar(St).floor(),ut=le;if(Q!==0&&(Y=G),Mt.bindFramebuffer(k.FRAMEBUFFER,Y)&&Mt.drawBuffers(R,Y),Mt.viewport(et),Mt.scissor(dt),Mt.setScissorTest(ut),K){let Tt=Ht.get(R.texture);k.framebufferTexture2D(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_CUBE_MAP_POSITIVE_X+z,Tt.__webglTexture,Q)}else if(Et){let Tt=z;for(let Lt=0;Lt<R.textures.length;Lt++){let zt=Ht.get(R.textures[Lt]);k.framebufferTextureLayer(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0+Lt,zt.__webglTexture,Q,Tt)}}else if(R!==null&&Q!==0){let Tt=Ht.get(R.texture);k.framebufferTexture2D(k.FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,Tt.__webglTexture,Q)}Z=-1};function Lr(R){let z=Ht.get(R);return(z.__readFormat!==R.format||z.__readType!==R.type)&&(z.__readFormat=R.format,z.__readType=R.type,z.__formatReadable=oe.textureFormatReadable(R.format),z.__typeReadable=oe.textureTypeReadable(R.type)),z}this.readRenderTargetPixels=function(R,z,Q,Y,K,Et,Pt,Tt=0){if(!(R&&R.isWebGLRenderTarget)){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Lt=Ht.get(R).__webglFramebuffer;if(R.isWebGLCubeRenderTarget&&Pt!==void 0&&(Lt=Lt[Pt],Array.isArray(Lt)&&(Lt=Lt[0])),Lt){Mt.bindFramebuffer(k.FRAMEBUFFER,Lt);try{let zt=R.textures[Tt],ee=zt.format,de=zt.type;R.textures.length>1&&k.readBuffer(k.COLOR_ATTACHMENT0+Tt);let Bt=Lr(zt);if(Bt.__formatReadable===!1){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Bt.__typeReadable===!1){te("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}z>=0&&z<=R.width-Y&&Q>=0&&Q<=R.height-K&&k.readPixels(z,Q,Y,K,gt.convert(ee),gt.convert(de),Et)}finally{let zt=lt!==null?Ht.get(lt).__webglFramebuffer:null;Mt.bindFramebuffer(k.FRAMEBUFFER,zt)}}},this.readRenderTargetPixelsAsync=async function(R,z,Q,Y,K,Et,Pt,Tt=0){if(!(R&&R.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Lt=Ht.get(R).__webglFramebuffer;if(R.isWebGLCubeRenderTarget&&Pt!==void 0&&(Lt=Lt[Pt],Array.isArray(Lt)&&(Lt=Lt[0])),Lt)if(z>=0&&z<=R.width-Y&&Q>=0&&Q<=R.height-K){Mt.bindFramebuffer(k.FRAMEBUFFER,Lt);let zt=R.textures[Tt],ee=zt.format,de=zt.type;R.textures.length>1&&k.readBuffer(k.COLOR_ATTACHMENT0+Tt);let Bt=Lr(zt);if(Bt.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Bt.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let fe=k.createBuffer();k.bindBuffer(k.PIXEL_PACK_BUFFER,fe),k.bufferData(k.PIXEL_PACK_BUFFER,Et.byteLength,k.STREAM_READ),k.readPixels(z,Q,Y,K,gt.convert(ee),gt.convert(de),0),k.bindBuffer(k.PIXEL_PACK_BUFFER,null);let Qe=lt!==null?Ht.get(lt).__webglFramebuffer:null;Mt.bindFramebuffer(k.FRAMEBUFFER,Qe);let Pe=k.fenceSync(k.SYNC_GPU_COMMANDS_COMPLETE,0);return k.flush(),await _g(k,Pe,4),k.bindBuffer(k.PIXEL_PACK_BUFFER,fe),k.getBufferSubData(k.PIXEL_PACK_BUFFER,0,Et),k.bindBuffer(k.PIXEL_PACK_BUFFER,null),k.deleteBuffer(fe),k.deleteSync(Pe),Et}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(R,z=null,Q=0){let Y=Math.pow(2,-Q),K=Math.floor(R.image.width*Y),Et=Math.floor(R.image.height*Y),Pt=z!==null?z.x:0,Tt=z!==null?z.y:0;qt.setTexture2D(R,0),k.copyTexSubImage2D(k.TEXTURE_2D,Q,0,0,Pt,Tt,K,Et),Mt.unbindTexture()},this.copyTextureToTexture=function(R,z,Q=null,Y=null,K=0,Et=0){let Pt,Tt,Lt,zt,ee,de,Bt,fe,Qe,Pe=R.isCompressedTexture?R.mipmaps[Et]:R.image;if(Q!==null)Pt=Q.max.x-Q.min.x,Tt=Q.max.y-Q.min.y,Lt=Q.isBox3?Q.max.z-Q.min.z:1,zt=Q.min.x,ee=Q.min.y,de=Q.isBox3?Q.min.z:0;else{let ce=Math.pow(2,-K);Pt=Math.floor(Pe.width*ce),Tt=Math.floor(Pe.height*ce),R.isDataArrayTexture?Lt=Pe.depth:R.isData3DTexture?Lt=Math.floor(Pe.depth*ce):Lt=1,zt=0,ee=0,de=0}Y!==null?(Bt=Y.x,fe=Y.y,Qe=Y.z):(Bt=0,fe=0,Qe=0);let Ie=gt.convert(z.format),vn=gt.convert(z.type),Ft;z.isData3DTexture?(qt.setTexture3D(z,0),Ft=k.TEXTURE_3D):z.isDataArrayTexture||z.isCompressedArrayTexture?(qt.setTexture2DArray(z,0),Ft=k.TEXTURE_2D_ARRAY):(qt.setTexture2D(z,0),Ft=k.TEXTURE_2D),Mt.activeTexture(k.TEXTURE0),Mt.pixelStorei(k.UNPACK_FLIP_Y_WEBGL,z.flipY),Mt.pixelStorei(k.UNPACK_PREMULTIPLY_ALPHA_WEBGL,z.premultiplyAlpha),Mt.pixelStorei(k.UNPACK_ALIGNMENT,z.unpackAlignment);let fn=Mt.getParameter(k.UNPACK_ROW_LENGTH),ge=Mt.getParameter(k.UNPACK_IMAGE_HEIGHT),os=Mt.getParameter(k.UNPACK_SKIP_PIXELS),pn=Mt.getParameter(k.UNPACK_SKIP_ROWS),Dr=Mt.getParameter(k.UNPACK_SKIP_IMAGES);Mt.pixelStorei(k.UNPACK_ROW_LENGTH,Pe.width),Mt.pixelStorei(k.UNPACK_IMAGE_HEIGHT,Pe.height),Mt.pixelStorei(k.UNPACK_SKIP_PIXELS,zt),Mt.pixelStorei(k.UNPACK_SKIP_ROWS,ee),Mt.pixelStorei(k.UNPACK_SKIP_IMAGES,de);let Xi=R.isDataArrayTexture||R.isData3DTexture,as=z.isDataArrayTexture||z.isData3DTexture;if(R.isDepthTexture){let ce=Ht.get(R),rn=Ht.get(z),Zn=Ht.get(ce.__renderTarget),Le=Ht.get(rn.__renderTarget);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,Zn.__webglFramebuffer),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,Le.__webglFramebuffer);for(let mn=0;mn<Lt;mn++)Xi&&(k.framebufferTextureLayer(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,Ht.get(R).__webglTexture,K,de+mn),k.framebufferTextureLayer(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,Ht.get(z).__webglTexture,Et,Qe+mn)),k.blitFramebuffer(zt,ee,zt+Pt,ee+Tt,Bt,fe,Bt+Pt,fe+Tt,k.DEPTH_BUFFER_BIT,k.NEAREST);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,null)}else if(K!==0||R.isRenderTargetTexture||Ht.has(R)){let ce=Ht.get(R),rn=Ht.get(z);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,N),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,W);for(let Zn=0;Zn<Lt;Zn++)Xi?k.framebufferTextureLayer(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,ce.__webglTexture,K,de+Zn):k.framebufferTexture2D(k.READ_FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,ce.__webglTexture,K),as?k.framebufferTextureLayer(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,rn.__webglTexture,Et,Qe+Zn):k.framebufferTexture2D(k.DRAW_FRAMEBUFFER,k.COLOR_ATTACHMENT0,k.TEXTURE_2D,rn.__webglTexture,Et),K!==0?k.blitFramebuffer(zt,ee,zt+Pt,ee+Tt,Bt,fe,Bt+Pt,fe+Tt,k.COLOR_BUFFER_BIT,k.NEAREST):as?k.copyTexSubImage3D(Ft,Et,Bt,fe,Qe+Zn,zt,ee,Pt,Tt):k.copyTexSubImage2D(Ft,Et,Bt,fe,zt,ee,Pt,Tt);Mt.bindFramebuffer(k.READ_FRAMEBUFFER,null),Mt.bindFramebuffer(k.DRAW_FRAMEBUFFER,null)}else as?R.isDataTexture||R.isData3DTexture?k.texSubImage3D(Ft,Et,Bt,fe,Qe,Pt,Tt,Lt,Ie,vn,Pe.data):z.isCompressedArrayTexture?k.compressedTexSubImage3D(Ft,Et,Bt,fe,Qe,Pt,Tt,Lt,Ie,Pe.data):k.texSubImage3D(Ft,Et,Bt,fe,Qe,Pt,Tt,Lt,Ie,vn,Pe):R.isDataTexture?k.texSubImage2D(k.TEXTURE_2D,Et,Bt,fe,Pt,Tt,Ie,vn,Pe.data):R.isCompressedTexture?k.compressedTexSubImage2D(k.TEXTURE_2D,Et,Bt,fe,Pe.width,Pe.height,Ie,Pe.data):k.texSubImage2D(k.TEXTURE_2D,Et,Bt,fe,Pt,Tt,Ie,vn,Pe);Mt.pixelStorei(k.UNPACK_ROW_LENGTH,fn),Mt.pixelStorei(k.UNPACK_IMAGE_HEIGHT,ge),Mt.pixelStorei(k.UNPACK_SKIP_PIXELS,os),Mt.pixelStorei(k.UNPACK_SKIP_ROWS,pn),Mt.pixelStorei(k.UNPACK_SKIP_IMAGES,Dr),Et===0&&z.generateMipmaps===!0&&z.mipmapsAutoUpdate===!0&&k.generateMipmap(Ft),Mt.unbindTexture()},this.initRenderTarget=function(R){Ht.get(R).__webglFramebuffer===void 0&&qt.setupRenderTarget(R)},this.initTexture=function(R){R.isCubeTexture?qt.setTextureCube(R,0):R.isData3DTexture?qt.setTexture3D(R,0):R.isDataArrayTexture||R.isCompressedArrayTexture?qt.setTexture2DArray(R,0):qt.setTexture2D(R,0),Mt.unbindTexture()},this.resetState=function(){q=0,V=0,lt=null,Mt.reset(),bt.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Ei}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorSpace=_e._getDrawingBufferColorSpace(t),e.unpackColorSpace=_e._getUnpackColorSpace()}};var yE=`
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
`,xE=`
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
`;function sf(i,t,e){return i.defines={...i.defines,...e?{CROWD_COLOR:1}:{}},i.onBeforeCompile=n=>{Object.assign(n.uniforms,t),n.vertexShader=n.vertexShader.replace("#include <common>",`#include <common>
${yE}`).replace("void main() {",`void main() {
${xE}`).replace("#include <beginnormal_vertex>","vec3 objectNormal = normalize(bent);").replace("#include <begin_vertex>",`vec3 transformed = worn ? skinned : vec3(0.0, 0.0, -1.0e4);
        #ifdef CROWD_COLOR
        vCloth = texelFetch(colorMap, ivec2(int(regionPart.x + 0.5), int(who.w + 0.5)), 0).rgb;
        vTint = texelFetch(boneMap, ivec2(57, row), 0);
        #endif`),e&&(n.fragmentShader=n.fragmentShader.replace("#include <common>",`#include <common>
varying vec3 vCloth;
varying vec4 vTint;`).replace("#include <color_fragment>","diffuseColor.rgb = mix(vCloth, vTint.rgb, vTint.a);"))},i.customProgramCacheKey=()=>`crowd${e?1:0}`,i}var of=3,rf=2048,Xa=232,a0=[190,64],l0=[16,80],vE=1e-4,bE=[22,26],bh=class{constructor(t){this.group=new ln,this.counts=[0,0,0],this.capacity=0,this._boneMap={value:null},this._colorMap={value:null},this._levels=t.map(e=>this._level(e.arrays)),this._shade=wE(),this.group.add(this._shade),this.reserve(64)}dress(t,e){let n=Math.max(1,t.colors?.length??0),s=new Uint8Array(4*e*n);(t.colors??[]).forEach((o,a)=>{for(let l=0;l<e;l++){let c=4*(a*e+l);for(let u=0;u<3;u++)s[c+u]=parseInt(o.slice(6*l+2*u,6*l+2*u+2),16);s[c+3]=255}}),this._colorMap.value?.dispose();let r=new Hs(s,e,n,si);r.colorSpace=bn,r.needsUpdate=!0,this._colorMap.value=r}reserve(t){if(t<=this.capacity)return;for(;this.capacity<t;)this.capacity=Math.max(64,2*this.capacity);this._boneMap.value?.dispose(),this.bones=new Float32Array(Xa*this.capacity);let e=new Hs(this.bones,Xa/4,this.capacity,si,li);this._boneMap.value=e;for(let n of this._levels)n.geometry.setAttribute("slot",SE(this.capacity)),n.geometry._maxInstanceCount=void 0;this._shade.geometry.setAttribute("spot",new ur(new Float32Array(4*this.capacity),4)),this._shade.geometry._maxInstanceCount=void 0}update(t,e,n,s){let r=t.people;this.reserve(r),this.shadeDepth=s,t.pose(this.bones,Xa);let{who:o,ids:a}=t.frame.arrays,{body:l,scale:c,parts:u}=t.description.people;for(let d=0;d<r;d++){let h=d*Xa+224;this.bones[h]=l[o[d]],this.bones[h+1]=c[o[d]],this.bones[h+2]=u[o[d]],this.bones[h+3]=o[d];let f=e.has(a[d])?.55:0;this.bones[h+4]=n.r,this.bones[h+5]=n.g,this.bones[h+6]=n.b,this.bones[h+7]=f}this._boneMap.value.needsUpdate=!0,this._state=t,this._raised=t.description.stage.ground.length>0}_ground(t){if(!this._raised)return 0;let e=this._state,{body:n,scale:s}=e.description.people,r=e.frame.arrays.who[t],o=1/0;for(let a of bE){let l=t*Xa+8*a,c=3*(28*n[r]+a),[u,d,h]=e.heads.subarray(c,c+3),[f,p,v,m,,,g]=this.bones.subarray(l,l+7),S=s[r],M=2*(f*v-m*p)*u+2*(p*v+m*f)*d+(1-2*(f*f+p*p))*h;o=Math.min(o,g+S*(M-h))}return Math.max(0,o)}choose(t,e,n=null){this.counts=[0,0,0];let s=this._state;if(!s?.frame)return;let{pelvis:r,ids:o}=s.frame.arrays,a=e/(2*Math.tan(.5*wo.degToRad(t.fov))),l=t.position,c=[];for(let d=0;d<s.people;d++){if(o[d]===n)continue;let h=Math.hypot(r[3*d]-l.x,r[3*d+1]-l.y,r[3*d+2]-l.z);c.push([h,d])}c.sort((d,h)=>d[0]-h[0]);let u=this._shade.geometry.attributes.spot;c.forEach(([d,h],f)=>{let p=1.7*a/Math.max(d,.1),v=p>a0[0]&&f<l0[0]?0:p>a0[1]&&f<l0[1]?1:2;this._levels[v].geometry.attributes.slot.array[this.counts[v]++]=h,u.array.set([r[3*h],r[3*h+1],this._ground(h),.42],4*f)}),this._levels.forEach((d,h)=>{d.geometry.instanceCount=this.counts[h],d.visible=this.counts[h]>0,d.geometry.attributes.slot.needsUpdate=!0}),this._shade.geometry.instanceCount=c.length,this._shade.material.uniforms.depth.value=this.shadeDepth,u.needsUpdate=!0}set shadows(t){for(let e of this._levels)e.castShadow=t;this._shade.visible=t}dispose(){for(let t of[...this._levels,this._shade])t.geometry.dispose(),t.material.dispose(),t.customDepthMaterial?.dispose();this._boneMap.value?.dispose(),this._colorMap.value?.dispose();for(let t of this._rests??[])t.dispose()}_level(t){let e=t.heads.length/84,n=t.rest.length/(3*e),s=new _o;s.setIndex(new Ge(t.faces,1)),s.setAttribute("position",new Ge(new Float32Array(t.normal.length),3)),s.setAttribute("normal",new Ge(t.normal,3)),s.setAttribute("source",new Ge(Float32Array.from(t.source),1)),s.setAttribute("boneIndex",new Ge(t.bones,4)),s.setAttribute("boneWeight",new Ge(t.weights,4,!0));let r=new Uint8Array(2*t.region.length);t.region.forEach((c,u)=>r.set([c,t.part[u]],2*u)),s.setAttribute("regionPart",new Ge(r,2));let o=ME(t.rest);(this._rests??=[]).push(o);let a={restMap:{value:o},boneMap:this._boneMap,colorMap:this._colorMap,vertices:{value:n}},l=new ke(s,sf(new Xn({side:$n}),a,!0));return l.customDepthMaterial=sf(new go,a,!1),l.frustumCulled=!1,l.castShadow=!0,this.group.add(l),l}};function SE(i){let t=new ur(new Float32Array(i),1);return t.setUsage(za),t}function ME(i){let t=i.length/3,e=Math.ceil(t/rf),n=new Float32Array(4*rf*e);for(let r=0;r<t;r++)for(let o=0;o<3;o++)n[4*r+o]=vE*i[3*r+o];let s=new Hs(n,rf,e,si,li);return s.needsUpdate=!0,s}function wE(){let i=new _o;i.setAttribute("position",new Re([-1,-1,0,1,-1,0,1,1,0,-1,1,0],3)),i.setIndex([0,1,2,0,2,3]);let t=new Ti({transparent:!0,depthWrite:!1,polygonOffset:!0,polygonOffsetFactor:-4,uniforms:{depth:{value:.4}},vertexShader:`attribute vec4 spot; varying vec2 at;
      void main() { at = position.xy;
        gl_Position = projectionMatrix * viewMatrix * vec4(spot.xyz + vec3(position.xy * spot.w, 0.012), 1.0); }`,fragmentShader:`uniform float depth; varying vec2 at;
      void main() { float r = length(at); gl_FragColor = vec4(0.0, 0.0, 0.0, depth * pow(max(0.0, 1.0 - r), 1.6)); }`}),e=new ke(i,t);return e.frustumCulled=!1,e.renderOrder=1,e}var EE=.004,c0=14;function u0(){return{scans:h0("scan",5),clouds:h0("cloud",2.5),ranges:RE(),forces:CE(),goals:PE()}}function TE(i=1){let t=new Ve,e=new dr(t,new Oi({transparent:!0,opacity:.9,linewidth:i}));return e.frustumCulled=!1,e}function af(i,t,e){let n=i.getAttribute("position");if(!n||n.array.length<e){let s=new Float32Array(Math.max(96,2*e));s.set(t.subarray?t.subarray(0,e):t),i.setAttribute("position",new Ge(s,3).setUsage(za))}else n.array.set(t.subarray?t.subarray(0,e):t),n.needsUpdate=!0;i.setDrawRange(0,e/3)}function h0(i,t){let e=new ma(new Ve,AE(t));return e.frustumCulled=!1,{object:e,update(n,s){let r=n.scans(i).map(c=>c.points),o=r.reduce((c,u)=>c+u.length,0),a=new Float32Array(o),l=0;for(let c of r)a.set(c,l),l+=c.length;e.material.color.set(s[i]),af(e.geometry,a,o)}}}function AE(i){let t=new fo({size:i,sizeAttenuation:!1,alphaTest:.5});return t.onBeforeCompile=e=>{e.fragmentShader=e.fragmentShader.replace("#include <alphatest_fragment>","if (length(gl_PointCoord - 0.5) > 0.5) discard;")},t}function RE(){let i=new Ve,t=new ke(i,new _i({transparent:!0,opacity:.22,depthWrite:!1,side:$n}));t.frustumCulled=!1;let e=new ni,n=new H;return{object:t,update(s,r){let o=s.frame.arrays.cones??new Float32Array(0),a=s.description.sensors.filter(c=>c.kind==="cone"),l=[];for(let c=0;c<o.length/9;c++){let[u,d,h,f,p,v,m,g]=o.subarray(9*c,9*c+9),S=a[c]?.angle??.2;e.set(p,v,m,f);let M=y=>{let C=2*Math.PI*y/c0;return n.set(g*Math.cos(S),g*Math.sin(S)*Math.cos(C),g*Math.sin(S)*Math.sin(C)),n.applyQuaternion(e),[u+n.x,d+n.y,h+n.z]};for(let y=0;y<c0;y++)l.push(u,d,h,...M(y),...M(y+1))}t.material.color.set(r.cone),af(i,l,l.length)}}}function CE(){let i=new ln,t=[];return{object:i,update(e,n){let s=e.frame.arrays.forces??new Float32Array(0),r=s.length/6;for(;t.length<r;){let o=new Pa(new H(1,0,0),new H,1,n.force);o.line.material.depthTest=o.cone.material.depthTest=!1,o.renderOrder=5,t.push(o),i.add(o)}t.forEach((o,a)=>{if(o.visible=a<r,!o.visible)return;let[l,c,u,d,h,f]=s.subarray(6*a,6*a+6),p=Math.hypot(d,h,f),v=Math.min(1.6,Math.max(.15,EE*p));o.position.set(l,c,u),p>1e-6&&o.setDirection(new H(d/p,h/p,f/p)),o.setLength(v,.25*v,.14*v),o.setColor(n.force)})}}}function PE(){let i=TE();return{object:i,update(t,e){let{goals:n,place:s}=t.frame.arrays,r=[];for(let o=0;n&&o<t.people;o++){let[a,l]=[n[2*o],n[2*o+1]];Number.isFinite(a)&&Number.isFinite(l)&&r.push(s[5*o],s[5*o+1],.02,a,l,.02)}i.material.color.set(e.goal),i.material.opacity=.5,af(i.geometry,r,r.length)}}}function d0(i,t=Math.PI/3){let e=i.index?i.toNonIndexed():i,n=e.attributes.position,s=n.count,r;if(n.isBufferAttribute===!0&&n.itemSize===3&&n.normalized===!1)r=n.array;else{r=new Float64Array(s*3);for(let y=0;y<s;y++)r[3*y+0]=n.getX(y),r[3*y+1]=n.getY(y),r[3*y+2]=n.getZ(y)}let o=Math.cos(t),a=(1+1e-10)*100,l=s/3,c=new Float64Array(l*3);for(let y=0;y<l;y++){let C=9*y,A=r[C+0],x=r[C+1],E=r[C+2],F=r[C+3],L=r[C+4],D=r[C+5],B=r[C+6],G=r[C+7],N=r[C+8],W=B-F,q=G-L,V=N-D,lt=A-F,Z=x-L,j=E-D,et=q*j-V*Z,dt=V*lt-W*j,ut=W*Z-q*lt,tt=1/(Math.sqrt(et*et+dt*dt+ut*ut)||1);c[3*y+0]=et*tt,c[3*y+1]=dt*tt,c[3*y+2]=ut*tt}let u=new Int32Array(s),d=new Float64Array(s*3),h=1;for(;h<s*2;)h<<=1;let f=h-1,p=new Int32Array(h),v=0;for(let y=0;y<s;y++){let C=3*y,A=Math.trunc(r[C+0]*a),x=Math.trunc(r[C+1]*a),E=Math.trunc(r[C+2]*a),F=(Math.imul(A,73856093)^Math.imul(x,19349663)^Math.imul(E,83492791))&f;for(;;){let L=p[F];if(L===0){let B=3*v;d[B+0]=A,d[B+1]=x,d[B+2]=E,p[F]=v+1,u[y]=v++;break}let D=3*(L-1);if(d[D+0]===A&&d[D+1]===x&&d[D+2]===E){u[y]=L-1;break}F=F+1&f}}let m=new Int32Array(v+1);for(let y=0;y<s;y++)m[u[y]+1]++;for(let y=0;y<v;y++)m[y+1]+=m[y];let g=new Int32Array(s),S=m.slice(0,v);for(let y=0;y<l;y++){let C=3*y;g[S[u[C+0]]++]=y,g[S[u[C+1]]++]=y,g[S[u[C+2]]++]=y}let M=new Float32Array(s*3);for(let y=0;y<l;y++){let C=3*y,A=c[C+0],x=c[C+1],E=c[C+2];for(let F=0;F<3;F++){let L=C+F,D=u[L],B=0,G=0,N=0;for(let q=m[D],V=m[D+1];q<V;q++){let lt=3*g[q],Z=c[lt+0],j=c[lt+1],et=c[lt+2];A*Z+x*j+E*et>o&&(B+=Z,G+=j,N+=et)}let W=1/(Math.sqrt(B*B+G*G+N*N)||1);M[3*L+0]=B*W,M[3*L+1]=G*W,M[3*L+2]=N*W}}return e.setAttribute("normal",new Ge(M,3,!1)),e}var IE=.6,Sh=class{constructor(){this.group=new ln,this._robots=[],this._geometries=new Map,this._material=new Xs({vertexColors:!0,roughness:.62,metalness:.05}),this._ghost=new Xs({vertexColors:!0,roughness:.6,transparent:!0,opacity:.45})}build(t,e){this.group.clear(),this._robots=t.map(n=>{let s=this._links(n.key,e.get(n.key)).map(o=>{let a=new ke(o,n.ghost?this._ghost:this._material);return a.castShadow=!n.ghost,a.receiveShadow=!0,a}),r=new ln;return s.length&&r.add(...s),this.group.add(r),{id:n.id,group:r,links:s}})}update(t,e=null){let{bots:n,links:s}=t.frame.arrays;for(let o of this._robots)o.group.visible=!1;let r=0;for(let o of n){let a=this._robots[o];a.group.visible=a.id!==e;for(let l of a.links)l.position.set(s[r],s[r+1],s[r+2]),l.quaternion.set(s[r+4],s[r+5],s[r+6],s[r+3]).normalize(),r+=7}}set shadows(t){for(let e of this._robots)for(let n of e.links)n.castShadow=t}dispose(){for(let t of this._geometries.values())for(let e of t)e.dispose();this._material.dispose(),this._ghost.dispose()}_links(t,e){return this._geometries.has(t)||this._geometries.set(t,LE(e.arrays)),this._geometries.get(t)}};function LE({vertices:i,faces:t,color:e,first:n}){let s=t.length/3,r=new Zt;return Array.from(n,(o,a)=>{let l=a+1<n.length?n[a+1]:s,c=new Float32Array(9*(l-o)),u=new Float32Array(9*(l-o));for(let h=o;h<l;h++){r.setRGB(e[4*h]/255,e[4*h+1]/255,e[4*h+2]/255,bn);for(let f=0;f<3;f++){let p=9*(h-o)+3*f;c.set(i.subarray(3*t[3*h+f],3*t[3*h+f]+3),p),u.set([r.r,r.g,r.b],p)}}let d=new Ve;return d.setAttribute("position",new Ge(c,3)),d.setAttribute("color",new Ge(u,3)),d0(d,IE)})}var er=.05;function f0(i,t){let e=DE[i.kind];if(!e)return null;let n=e(i,t);return n.position.set(i.x,i.y,0),n.rotation.z=i.heading,n.userData.rise=i.kind==="cube"?.5*i.size:0,n}function p0(i,t){let e=Mh(i.width,.04,i.height,new Xs({color:t.door,transparent:!0,opacity:.55,roughness:.25}));e.position.set(.5*i.width,0,.5*i.height);let n=new ln;return n.add(e),n.position.set(i.x,i.y,0),n.rotation.z=i.yaw,n}var DE={cube({size:i,color:t}){let e=new ln,n=Mh(i,i,i,new Xn({color:new Zt().setRGB(...t,bn)}));return n.position.z=.5*i,e.add(n),e},table({length:i,width:t,height:e},n){let s=new Xn({color:n.prop}),r=new ln,o=Mh(i,t,er,s);o.position.z=e-.5*er,r.add(o);for(let a of[-1,1])for(let l of[-1,1]){let c=Mh(er,er,e-er,s);c.position.set(.5*a*(i-er),.5*l*(t-er),.5*(e-er)),r.add(c)}return r},tree({height:i,trunk:t,crown:e}){let n=new ln,s=Math.max(.3*i,i-1.6*e),r=.5*(i-s)+.2*e,o=lf(new Ws(.8*t,t,s,12).rotateX(Math.PI/2),new Xn({color:"#73543a"}));o.position.z=.5*s;let a=lf(new Sa(1,3),new Xn({color:"#5f8f4c"}));return a.scale.set(e,e,r),a.position.z=i-r,n.add(o,a),n}};function Mh(i,t,e,n){return lf(new Vs(i,t,e),n)}function lf(i,t){let e=new ke(i,t);return e.castShadow=e.receiveShadow=e.userData.casts=!0,e}var NE=1.1,m0=.06,wh=class{constructor(){this.group=new ln,this.parts={};for(let t of["floor","walls","props","zones"])this.parts[t]=new ln,this.group.add(this.parts[t]);this._doors=[],this._props=new Map,this._height=2.5,this._full=!1}build(t,e){this._clear();let{stage:n,zones:s,bounds:r}=t;this._floor(r,e),this._walls(n,e),this._height=n.height,this.full=this._full;for(let o of n.ground)this.parts.floor.add(OE(o,e));this._doors=n.doors.map(o=>{let a=p0(o,e);return this.parts.props.add(a),{door:o,mesh:a}}),n.props.forEach((o,a)=>{let l=f0(o,e);l&&(this.parts.props.add(l),this._props.set(a,l))});for(let o of s)this.parts.zones.add(...kE(o,e));for(let o of t.robots)o.ghost||this.parts.zones.add(...BE(o,e))}set full(t){this._full=t,this.parts.walls.scale.z=t?1:Math.min(1,NE/this._height)}update(t){t.doors&&this._doors.forEach(({door:e,mesh:n},s)=>zE(e,n,t.doors[s])),t.props&&t.propnum.forEach((e,n)=>{let s=this._props.get(e);if(!s)return;let[r,o,a,l,c,u,d]=t.props.subarray(7*n,7*n+7);s.position.set(r,o,a-s.userData.rise),s.quaternion.set(c,u,d,l);let h=new H(0,0,-s.userData.rise).applyQuaternion(s.quaternion);s.position.set(r+h.x,o+h.y,a+h.z)})}set grid(t){this._grid&&(this._grid.shown.value=t?1:0)}set shadows(t){this.group.traverse(e=>{e.userData.casts&&(e.castShadow=t)})}dispose(){this._clear()}_clear(){for(let t of Object.values(this.parts))t.traverse(e=>{e.geometry?.dispose(),e.material?.map?.dispose(),e.material?.dispose()}),t.clear();this._doors=[],this._props.clear()}_floor([t,e,n,s],r){let o=120+2*Math.max(n-t,s-e);this._grid=FE(r);let a=new ke(new pr(o,o),this._grid.material);a.position.set(.5*(t+n),.5*(e+s),0),a.receiveShadow=!0,this.parts.floor.add(a)}_walls({walls:t,height:e},n){let s=[],r=[],o=[];for(let l of t){let c=l.solid?l.points:UE(l.points),u=c.length;for(let d=0;d<u;d++){let[h,f]=[c[d],c[(d+1)%u]];s.push(h[0],h[1],0,f[0],f[1],0,f[0],f[1],e,h[0],h[1],0,f[0],f[1],e,h[0],h[1],e),o.push(h[0],h[1],e,f[0],f[1],e),l.inner&&o.push(h[0],h[1],.01,f[0],f[1],.01)}l.inner||r.push(...g0(c,e))}if(!s.length)return;this.parts.walls.add($a(s,new Xn({color:n.wall}),!0)),r.length&&this.parts.walls.add($a(r,new Xn({color:n.wallTop}),!1));let a=new Ve;a.setAttribute("position",new Re(o,3)),this.parts.walls.add(new dr(a,new Oi({color:n.wallTop})))}};function g0(i,t){let e=i.map(([n,s])=>new Vt(n,s));return mo.isClockWise(e)&&e.reverse(),mo.triangulateShape(e,[]).flatMap(n=>n.flatMap(s=>[e[s].x,e[s].y,t]))}function $a(i,t,e){let n=new Ve;n.setAttribute("position",new Re(i,3)),n.computeVertexNormals();let s=new ke(n,t);return s.castShadow=s.userData.casts=e,s.receiveShadow=!0,s}function UE([[i,t],[e,n]]){let s=Math.hypot(e-i,n-t)||1,[r,o]=[-.5*m0*(n-t)/s,.5*m0*(e-i)/s];return[[i-r,t-o],[e-r,n-o],[e+r,n+o],[i+r,t+o]]}function FE(i){let t=new Xn({color:i.floor,polygonOffset:!0,polygonOffsetFactor:2,polygonOffsetUnits:8}),e={value:1};return t.onBeforeCompile=n=>{Object.assign(n.uniforms,{gridShown:e,gridLine:{value:new Zt(i.line)},gridLine10:{value:new Zt(i.line10)}}),n.vertexShader=n.vertexShader.replace("#include <common>",`#include <common>
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
        diffuseColor.rgb = mix(diffuseColor.rgb, gridLine10, gridShown * gridAt(10.0, 1.4));`)},{material:t,shown:e}}function OE({corners:i,heights:t},e){let n=i.map(([r,o],a)=>[r,o,t[a]]),s=[...n[0],...n[1],...n[2],...n[0],...n[2],...n[3]];for(let r=0;r<4;r++){let[o,a]=[n[r],n[(r+1)%4]];s.push(o[0],o[1],0,a[0],a[1],0,...a,o[0],o[1],0,...a,...o)}return $a(s,new Xn({color:e.ground}),!0)}function kE(i,t){let e=t[i.kind],n=$a(g0(i.points,.006),new _i({color:e,transparent:!0,opacity:i.kind==="start"?.05:.14,depthWrite:!1}),!1);n.receiveShadow=!1;let s=new Ve().setFromPoints(i.points.map(([o,a])=>new H(o,a,.012))),r=new pa(s,i.kind==="goal"||i.kind==="exit"?new Ma({color:e,dashSize:.25,gapSize:.15}):new Oi({color:e}));return r.computeLineDistances(),[n,r]}function BE({goal:i},t){let e=new ke(new mr(Math.max(.05,i.tolerance-.05),i.tolerance,48),new _i({color:t.robotGoal,transparent:!0,opacity:.9}));e.position.set(i.x,i.y,.014);let n=new ke(new Ws(.018,.018,1.5,10).rotateX(Math.PI/2),new Xn({color:t.ink}));n.position.set(i.x,i.y,.75);let s=$a([0,0,1.5,0,0,1.15,.5,0,1.32],new _i({color:t.robotGoal,side:$n}),!0);return s.position.set(i.x,i.y,0),[e,n,s]}function zE(i,t,e){i.kind==="sliding"?t.position.set(i.x-e*i.width*Math.cos(i.yaw),i.y-e*i.width*Math.sin(i.yaw),0):t.rotation.z=i.yaw+e*i.angle}var _0={type:"change"},hf={type:"start"},x0={type:"end"},Eh=new _s,y0=new zn,HE=Math.cos(70*wo.DEG2RAD),En=new H,ci=2*Math.PI,we={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},cf=1e-6,Th=class extends Ia{constructor(t,e=null){super(t,e),this.state=we.NONE,this.target=new H,this.cursor=new H,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:Js.ROTATE,MIDDLE:Js.DOLLY,RIGHT:Js.PAN},this.touches={ONE:js.ROTATE,TWO:js.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new H,this._lastQuaternion=new ni,this._lastTargetPosition=new H,this._quat=new ni().setFromUnitVectors(t.up,new H(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new Ks,this._sphericalDelta=new Ks,this._scale=1,this._panOffset=new H,this._rotateStart=new Vt,this._rotateEnd=new Vt,this._rotateDelta=new Vt,this._panStart=new Vt,this._panEnd=new Vt,this._panDelta=new Vt,this._dollyStart=new Vt,this._dollyEnd=new Vt,this._dollyDelta=new Vt,this._dollyDirection=new H,this._mouse=new Vt,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=VE.bind(this),this._onPointerDown=GE.bind(this),this._onPointerUp=WE.bind(this),this._onContextMenu=JE.bind(this),this._onMouseWheel=qE.bind(this),this._onKeyDown=YE.bind(this),this._onTouchStart=ZE.bind(this),this._onTouchMove=KE.bind(this),this._onMouseDown=XE.bind(this),this._onMouseMove=$E.bind(this),this._interceptControlDown=jE.bind(this),this._interceptControlUp=QE.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(t){this._cursorStyle=t,t==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(t){super.connect(t),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=we.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(_0),this.update(),this.state=we.NONE}pan(t,e){this._pan(t,e),this.update()}dollyIn(t){this._dollyIn(t),this.update()}dollyOut(t){this._dollyOut(t),this.update()}rotateLeft(t){this._rotateLeft(t),this.update()}rotateUp(t){this._rotateUp(t),this.update()}update(t=null){let e=this.object.position;En.copy(e).sub(this.target),En.applyQuaternion(this._quat),this._spherical.setFromVector3(En),this.autoRotate&&this.state===we.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=ci:n>Math.PI&&(n-=ci),s<-Math.PI?s+=ci:s>Math.PI&&(s-=ci),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(En.setFromSpherical(this._spherical),En.applyQuaternion(this._quatInverse),e.copy(this.target).add(En),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=En.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new H(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new H(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=En.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(Eh.origin.copy(this.object.position),Eh.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(Eh.direction))<HE?this.object.lookAt(this.target):(y0.setFromNormalAndCoplanarPoint(this.object.up,this.target),Eh.intersectPlane(y0,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>cf||8*(1-this._lastQuaternion.dot(this.object.quaternion))>cf||this._lastTargetPosition.distanceToSquared(this.target)>cf?(this.dispatchEvent(_0),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?ci/60*this.autoRotateSpeed*t:ci/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){En.setFromMatrixColumn(e,0),En.multiplyScalar(-t),this._panOffset.add(En)}_panUp(t,e){this.screenSpacePanning===!0?En.setFromMatrixColumn(e,1):(En.setFromMatrixColumn(e,0),En.crossVectors(this.object.up,En)),En.multiplyScalar(t),this._panOffset.add(En)}_pan(t,e){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;En.copy(s).sub(this.target);let r=En.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/n.clientHeight,this.object.matrix),this._panUp(2*e*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=t-n.left,r=e-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientY),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(ci*this._rotateDelta.x/e.clientHeight),this._rotateUp(ci*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(ci*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(-ci*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(ci*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(-ci*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(n,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let n=this._getSecondPointerPosition(t),s=.5*(t.pageX+n.x),r=.5*(t.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(ci*this._rotateDelta.x/e.clientHeight),this._rotateUp(ci*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new Vt,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,n={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function GE(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function VE(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function WE(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(x0),this.state=we.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function XE(i){let t;switch(i.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case Js.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=we.DOLLY;break;case Js.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=we.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=we.ROTATE}break;case Js.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=we.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=we.PAN}break;default:this.state=we.NONE}this.state!==we.NONE&&this.dispatchEvent(hf)}function $E(i){switch(this.state){case we.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case we.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case we.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function qE(i){this.enabled===!1||this.enableZoom===!1||this.state!==we.NONE||(i.preventDefault(),this.dispatchEvent(hf),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(x0))}function YE(i){this.enabled!==!1&&this._handleKeyDown(i)}function ZE(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case js.ROTATE:if(this.enableRotate===!1){this.state=we.NONE;break}this._handleTouchStartRotate(i),this.state=we.TOUCH_ROTATE;break;case js.PAN:if(this.enablePan===!1){this.state=we.NONE;break}this._handleTouchStartPan(i),this.state=we.TOUCH_PAN;break;default:this.state=we.NONE}break;case 2:switch(this.touches.TWO){case js.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=we.TOUCH_DOLLY_PAN;break;case js.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=we.TOUCH_DOLLY_ROTATE;break;default:this.state=we.NONE}break;default:this.state=we.NONE}this.state!==we.NONE&&this.dispatchEvent(hf)}function KE(i){switch(this._trackPointer(i),this.state){case we.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case we.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case we.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case we.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=we.NONE}}function JE(i){this.enabled!==!1&&i.preventDefault()}function jE(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function QE(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var v0=45,tT=75,eT=24,nT=17,Ah=class{constructor(t){this.camera=new ti(v0,1,.1,500),this.camera.up.set(0,0,1),this.controls=new Th(this.camera,t),this.controls.maxPolarAngle=.495*Math.PI,this.controls.minDistance=.6,this.controls.maxDistance=250,this.controls.zoomToCursor=!0,this.name="free",this._target=null,this._last=null,t.addEventListener("keydown",e=>this._key(e))}list(t){return[{name:"free",title:"Free"},{name:"overview",title:"Overview"},{name:"beside",title:"Beside"},{name:"follow",title:"Follow"},...t.robots.map(e=>({name:`robot:${e.name}`,title:`From ${e.name}`}))]}choose(t,e,n){this.name=t,this._target=n??this._target,this.controls.enabled=!t.startsWith("robot:"),this.camera.fov=t.startsWith("robot:")?tT:v0,this.camera.updateProjectionMatrix(),t==="overview"&&this.overview(e,!0),t==="follow"&&(this._start=!0),this._last=null}set target(t){this._target=t}followed(t){if(this._target&&t.place(this._target.kind,this._target.id))return this._target;let{bots:e,ids:n}=t.frame.arrays;return e.length?{kind:"robot",id:t.description.robots[e[0]].id}:n.length?{kind:"person",id:n[0]}:null}inside(t){return this.name.startsWith("robot:")?t.robots.find(e=>`robot:${e.name}`===this.name)?.id??null:null}overview({bounds:[t,e,n,s],focus:r},o=!1){let a=new H(.5*(t+n),.5*(e+s),.6),l=o?1.05:.62,c=n-t>=s-e?-.5*Math.PI:Math.PI,u=o?c:c+.35,d=new H(Math.cos(u)*Math.cos(l),Math.sin(u)*Math.cos(l),Math.sin(l)),h=[];for(let f of[t,n])for(let p of[e,s])for(let v of[0,1.8])h.push(new H(f,p,v));for(let f=0;f<3;f++){let[p,v]=[1,400];for(let m=0;m<20;m++){let g=.5*(p+v);this._look(a,d,g),h.every(S=>this._sees(S))?v=g:p=g}this._look(a,d,v),this._center(a,h),this._away=v}!o&&this._away>eT?(a.set(r[0],r[1],.8),this._look(a,d,nT)):this._look(a,d,this._away),this.controls.target.copy(a),this.controls.update()}update(t){t.frame&&(this.name==="follow"?this._follow(t):this.name==="beside"?this._accompany(t):this.name.startsWith("robot:")?this._ride(t):this.controls.update())}dispose(){this.controls.dispose()}_look(t,e,n){this.camera.position.copy(t).addScaledVector(e,n),this.camera.lookAt(t),this.camera.updateMatrixWorld(),this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert()}_center(t,e){let n=e.map(a=>a.clone().project(this.camera)),s=["x","y"].map(a=>{let l=n.map(c=>c[a]);return .5*(Math.min(...l)+Math.max(...l))}),r=new Zs;r.setFromCamera(new Vt(...s),this.camera);let o=r.ray.intersectPlane(new zn(new H(0,0,1),-t.z),new H);o&&t.copy(o)}_sees(t){let e=t.clone().project(this.camera);return Math.abs(e.x)<.97&&Math.abs(e.y)<.95&&e.z<1}_follow(t){let e=this.followed(t);if(!e)return;let[n,s,r]=t.place(e.kind,e.id),o=new H(n,s,.75*t.height(e.kind,e.id));this._start?(this.camera.position.set(n-4.2*Math.cos(r-.4),s-4.2*Math.sin(r-.4),2.9),this._start=!1):this.camera.position.add(o.clone().sub(this.controls.target)),this.controls.target.copy(o),this.controls.update()}_accompany(t){let e=this.followed(t);if(e){let[n,s]=t.place(e.kind,e.id),r=new H(n,s,0).sub(this._last??new H(this.controls.target.x,this.controls.target.y,0));this.controls.target.add(r),this.camera.position.add(r),this._last=new H(n,s,0)}this.controls.update()}_ride(t){let e=this.inside(t.description),n=e===null?null:t.place("robot",e);if(!n)return;let[s,r,o]=n,a=Math.max(.6,t.height("robot",e));this.camera.position.set(s,r,a),this.camera.lookAt(s+Math.cos(o),r+Math.sin(o),a-.12)}_key(t){let e={ArrowLeft:[1,0],ArrowRight:[-1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[t.key];if(!e||!t.shiftKey||!this.controls.enabled)return;t.preventDefault();let n=this.camera.position.clone().sub(this.controls.target),s=new Ks().setFromCartesianCoords(n.x,n.z,-n.y);s.theta+=.12*e[0],s.phi=Math.min(this.controls.maxPolarAngle,Math.max(.05,s.phi+.12*e[1]));let r=new H().setFromSpherical(s);this.camera.position.copy(this.controls.target).add(new H(r.x,-r.z,r.y))}};var iT=new H(-.42,-.55,1),uf=22,df=2048,Rh=class{constructor(t,e){this.canvas=t,this.state=new Gr,this._resource=e,this._renderer=new _h({canvas:t,antialias:!0,powerPreference:"high-performance"}),this._renderer.shadowMap.enabled=!0,this._renderer.shadowMap.type=gr,this._renderer.info.autoReset=!1,this._scene=new ua,this._views=new Ah(t),this._layers=new Map(Hr.map(n=>[n.name,{...n}])),this._marked=new Map,this._frames=0,this._theme="light",this._build(),this.setTheme(this._theme)}async load(t){let e=this._bodies??Promise.all([...Array(of).keys()].map(a=>this._fetch(`bodies/${a}.bin`)));this._bodies=e;let n=new Map,s=t.robots.map(async a=>{n.set(a.key,await this._fetch(a.mesh,{key:a.key}))}),[r]=await Promise.all([e,...s]);this._crowd||(this._crowd=new bh(r),this._scene.add(this._crowd.group));let o=JSON.stringify(this.state.description?.bounds)!==JSON.stringify(t.bounds);this.state.describe(t,r[of-1]),this._crowd.dress(t.people,t.regions.length),this._robots.build(t.robots,n),this._stage.build(t,this._look);for(let{name:a,title:l}of t.layers)this._layers.has(a)||this._layers.set(a,{name:a,title:l,visible:a==="scans"});this._showLayers(),this._resize(),o&&(this._views.overview(t),this._views.name==="free"&&t.robots.length&&this._views.choose("beside",t,null))}apply(t){if(!this.state.apply(t))return!1;this._crowd.update(this.state,new Set(this._marks("person")),this._markColor,this._look.shade),this._robots.update(this.state,this._views.inside(this.state.description)),this._stage.update(t.arrays);for(let[e,n]of Object.entries(this._overlays))n.object.visible&&n.update(this.state,this._look,e);return!0}layers(){return[...this._layers.values()].map(t=>({...t}))}wanted(){let t=new Set(Hr.map(e=>e.name));return this.layers().filter(e=>e.visible&&!t.has(e.name)).map(e=>e.name)}setLayer(t,e){if(!this._layers.has(t))throw new Error(`the scene has no layer ${t}`);this._layers.get(t).visible=e,this._showLayers()}cameras(){return this.state.description?this._views.list(this.state.description):[]}get camera(){return this._views.name}setCamera(t,e=null){this._views.choose(t,this.state.description,e),this._stage.full=t==="follow"||t.startsWith("robot:"),this.state.frame&&this._robots.update(this.state,this._views.inside(this.state.description))}reset(){this.setCamera("free"),this._views.overview(this.state.description)}pick(t,e){if(!this.state.frame)return null;let{clientWidth:n,clientHeight:s}=this.canvas,r=new Zs;r.setFromCamera(new Vt(2*t/n-1,1-2*e/s),this._views.camera);let o=null;for(let a of this._targets()){let l=new H(a.x,a.y,a.z),c=new H(a.x,a.y,a.z+a.height),u=new H;if(r.ray.distanceSqToSegment(l,c,u)>a.radius**2)continue;let d=u.distanceTo(r.ray.origin);(!o||d<o.away)&&(o={kind:a.kind,id:a.id,away:d})}return o&&{kind:o.kind,id:o.id}}floor(t,e){let{clientWidth:n,clientHeight:s}=this.canvas,r=new Zs;r.setFromCamera(new Vt(2*t/n-1,1-2*e/s),this._views.camera);let o=r.ray.intersectPlane(new zn(new H(0,0,1),0),new H);return o&&{x:o.x,y:o.y}}highlight(t,e){this._marked=new Map(t==null?[]:[[`${t} ${e}`,{kind:t,id:e}]]),this._views.target=this._marked.size?{kind:t,id:e}:null,this.state.frame&&this.apply(this.state.frame)}setTheme(t){this._theme=t==="dark"?"dark":"light",this._look=Yo[this._theme],this._markColor=new Zt(this._look.mark),this._scene.background=new Zt(this._look.sky),this._scene.fog=new ha(this._look.sky,45,170),this._sun.intensity=this._look.sun,this._dome.intensity=this._look.dome,this._ring.material.color.set(this._look.mark),this.state.description&&(this._stage.build(this.state.description,this._look),this._showLayers(),this.state.frame&&this.apply(this.state.frame))}info(){let{render:t,memory:e}=this._renderer.info,{position:n}=this._views.camera;return{people:this.state.walkers,robots:this.state.frame?this.state.frame.arrays.bots.length:0,levels:this._crowd?[...this._crowd.counts]:[0,0,0],time:this.state.time,sequence:this.state.frame?this.state.frame.sequence:0,calls:t.calls,triangles:t.triangles,geometries:e.geometries,textures:e.textures,frames:this._frames,milliseconds:this._spent,camera:this._views.name,eye:[n.x,n.y,n.z],theme:this._theme}}render(){let t=performance.now();this._resize(),this._views.update(this.state),this._crowd?.choose(this._views.camera,this._renderer.domElement.height),this._light(),this._mark(),this._renderer.info.reset(),this._renderer.render(this._scene,this._views.camera),this._frames+=1,this._spent=performance.now()-t}dispose(){this._views.dispose(),this._crowd?.dispose(),this._robots.dispose(),this._stage.dispose(),this._renderer.dispose()}_build(){this._sun=new Ca("#fff8ef",2),this._sun.castShadow=!0,this._sun.shadow.mapSize.set(df,df),this._sun.shadow.bias=-6e-4,this._sun.shadow.normalBias=.03,this._sun.shadow.radius=4,this._dome=new Ta("#f6f9ff","#b9bcc0",1.4),this._stage=new wh,this._robots=new Sh,this._overlays=u0(),this._ring=new ke(new mr(.85,1,56),new _i({depthTest:!1,transparent:!0,opacity:.95})),this._ring.visible=!1,this._scene.add(this._sun,this._sun.target,this._dome,this._stage.group,this._robots.group,this._ring);for(let t of Object.values(this._overlays))this._scene.add(t.object)}async _fetch(t,e){let n=await fetch(this._resource(t,e));if(!n.ok)throw new Error(`${t}: ${(await n.text()).trim()}`);return Ps(await n.arrayBuffer())}_marks(t){return[...this._marked.values()].filter(e=>e.kind===t).map(e=>e.id)}_mark(){let[t]=this._marked.values(),e=t&&this.state.place(t.kind,t.id);if(this._ring.visible=!!e,!e)return;let n=t.kind==="robot"?this.state.description.robots.find(s=>s.id===t.id).radius+.12:.42;this._ring.position.set(e[0],e[1],.02),this._ring.scale.setScalar(n)}_targets(){let{ids:t,pelvis:e,bots:n,botplace:s}=this.state.frame.arrays,r=Array.from(t,(a,l)=>({kind:"person",id:a,x:e[3*l],y:e[3*l+1],z:e[3*l+2]-.9,height:this.state.height("person",a),radius:.3}));return[...Array.from(n,(a,l)=>{let{id:c,radius:u,height:d}=this.state.description.robots[a];return{kind:"robot",id:c,x:s[5*l],y:s[5*l+1],z:0,height:d,radius:u}}),...r]}_showLayers(){let t=e=>this._layers.get(e)?.visible??!1;for(let e of["walls","props","zones"])this._stage.parts[e].visible=t(e);this._stage.grid=t("grid"),this._robots.group.visible=t("robots");for(let[e,n]of Object.entries(this._overlays))n.object.visible=t(e);this._crowd&&(this._crowd.group.visible=t("people"),this._crowd.shadows=t("shadows")),this._stage.shadows=this._robots.shadows=this._sun.castShadow=t("shadows")}_light(){let t=this._views.controls.target,e=this._views.camera.position,n=Math.min(uf,Math.max(7,.75*e.distanceTo(t))),s=this._views.name.startsWith("robot:")?e:t,r=this._sun.shadow.camera;r.left=r.bottom=-n,r.right=r.top=n,r.near=1,r.far=4*uf,r.updateProjectionMatrix();let o=2*n/df;this._sun.target.position.set(o*Math.round(s.x/o),o*Math.round(s.y/o),0),this._sun.position.copy(this._sun.target.position).addScaledVector(iT.clone().normalize(),2*uf)}_resize(){let t=Math.min(2,devicePixelRatio||1),{clientWidth:e,clientHeight:n}=this.canvas;!e||!n||e===this._width&&n===this._height&&t===this._ratio||(Object.assign(this,{_width:e,_height:n,_ratio:t}),this._renderer.setPixelRatio(t),this._renderer.setSize(e,n,!1),this._views.camera.aspect=e/n,this._views.camera.updateProjectionMatrix())}};function b0(i,{bounds:t,walls:e,discs:n,since:s},r){let o=Math.min(2,devicePixelRatio||1),[a,l]=[i.clientWidth*o,i.clientHeight*o];(i.width!==a||i.height!==l)&&Object.assign(i,{width:a,height:l});let c=i.getContext("2d"),u=r==="dark",[d,h,f,p]=t,v=.92*Math.min(a/(f-d),l/(p-h)),g=matchMedia("(prefers-reduced-motion: reduce)").matches?0:(performance.now()-s)/1e3%12;c.setTransform(1,0,0,1,0,0),c.fillStyle=u?"#141a21":"#e3e9f0",c.fillRect(0,0,a,l),c.setTransform(v,0,0,-v,.5*a-.5*v*(d+f),.5*l+.5*v*(h+p)),c.lineWidth=2/v,c.strokeStyle=u?"#a9b7c4":"#6c7884";for(let S of e)c.beginPath(),S.forEach(([M,y],C)=>C?c.lineTo(M,y):c.moveTo(M,y)),S.length>2&&c.closePath(),c.stroke();for(let[S,M,y,C,A,x]of n)c.beginPath(),c.fillStyle=x?"#d55e00":"#0072b2",c.arc(S+y*g,M+C*g,A,0,2*Math.PI),c.fill()}var sT=800,rT=5,Ao=class{constructor(t,e,n="simulator"){this.app=t,this.desk=n,this.actions=e,this.placing=!1,this.frames=0,this._waiting=null,this._loading=null,this._awake=0,this._shown=!0,this.place=_("div",{class:"stage-place"}),this.overlay=_("canvas",{class:"preview","aria-hidden":"true",hidden:!0}),this.note=_("p",{class:"picture-note",role:"status"}),this.element=_("div",{class:"picture"},this.place,this.overlay,this.note),this._make(t.address.get("view")??"3d"),this._listen(),requestAnimationFrame(()=>this._tick())}take(t){if(!(!this._shown||!this.scene))return this._finish(),this.newest=t,new Promise(e=>{this._waiting=e})}preview(t){this._preview=t&&{...t,since:performance.now()},this.overlay.hidden=!t,t&&(this.newest=null)}say(t){this.note.textContent!==t&&(this.note.textContent=t),this.note.hidden=!t}set shown(t){this._shown=t,t||this._finish(),this.wake()}wake(){this._awake=performance.now()+sT}mark(t,e){this.scene?.state.frame&&this.scene.highlight(t,e),this.wake()}setView(t){t!==this.view&&(this.scene.dispose(),this._make(t),this.app.remember({view:t}),this.app.connection.call(`${this.desk}.show_frame`).catch(()=>{}))}_make(t){this.canvas=_("canvas",{class:"stage",tabindex:"0",role:"img","aria-label":"Picture of the simulation"}),this.place.replaceChildren(this.canvas);let e=(n,s)=>this.app.connection.address(this.desk,n,s);this.view=t==="2d"?"2d":"3d";try{this.scene=this.view==="2d"?new vl(this.canvas,e):new Rh(this.canvas,e)}catch(n){return Te(`The picture in space needs WebGL, so the one from above is shown: ${n.message}`,"error"),this._make("2d")}return this.scene.setTheme(this.app.theme),this._listenCanvas(),this.wake()}_listen(){document.addEventListener("theme",t=>{this.scene?.setTheme(t.detail),this.wake()}),new ResizeObserver(()=>this.wake()).observe(this.element)}_listenCanvas(){let t=null;for(let e of["pointermove","wheel","keydown"])this.canvas.addEventListener(e,()=>this.wake(),{passive:!0});this.canvas.addEventListener("pointerdown",e=>{t=[e.offsetX,e.offsetY],this.wake()}),this.canvas.addEventListener("pointerup",e=>{!t||Math.hypot(e.offsetX-t[0],e.offsetY-t[1])>rT||e.button!==0||this._click(e.offsetX,e.offsetY)})}_click(t,e){if(this.scene?.state.frame)if(this.placing){let n=this.scene.floor(t,e);n&&this.actions.place(n)}else this.actions.select(this.scene.pick(t,e))}_finish(){this._waiting?.(),this._waiting=null}_tick(){if(requestAnimationFrame(()=>this._tick()),!this._shown||!this.scene||!this.canvas.clientWidth)return this._finish();this._preview&&b0(this.overlay,this._preview,this.app.theme);let t=this._waiting!==null;if(t&&this._apply(),!(!t&&performance.now()>this._awake))return this.scene.state.frame&&this.scene.render(),this._finish()}_apply(){if(!(!this.newest||this._loading)){if(this.scene.apply(this.newest)){this.frames+=1,this.preview(null);return}this._loading=this._load().catch(t=>Te(t.message,"error"))}}async _load(){try{let t=await this.app.connection.call(`${this.desk}.description`);t.revision!==void 0&&(await this.scene.load(t),this.actions.loaded?.(t)),this.newest&&this.scene.apply(this.newest)&&this.preview(null),this.wake()}finally{this._loading=null}this.app.connection.call(`${this.desk}.show_frame`).catch(()=>{})}};var ff=class{constructor(t,e){Object.assign(this,{root:t,app:e,state:{open:!1},form:null}),this.participant=e.address.get("role")==="participant",this.trial=new Ao(e,{select(){},place(){}},"experiments"),this.screen=_("div",{class:"screen","aria-live":"polite"}),this.side=_("aside",{"aria-label":"Operator"}),t.classList.add("experiments"),this.participant&&document.body.classList.add("participant"),It(t,this.screen,this.participant?null:this.side),e.connection.on("experiments.state",n=>this.update(n)),e.connection.on("experiments.progress",n=>this.progress(n)),e.connection.draw("trial",n=>this.trial.take(n))}async call(t,e={}){let n=await ve(()=>this.app.connection.call(`experiments.${t}`,e));return n&&"open"in n&&this.update(n),n}update(t){let e=JSON.stringify(t)===JSON.stringify(this.state)&&this.drawn;this.state=t,!e&&(this.drawn=!0,this.form=null,t.open?t.phase==="screen"?this.showScreen():t.phase==="running"?this.showTrial():t.phase==="pause"?this.showPause():this.showEnd():this.showStart(),this.participant||this.showOperator())}async showStart(){if(this.participant)return It(this.screen,_("h2",{},"The experiment has not started yet."));let t=await this.call("sources");if(!t)return;let e=_("select",{},t.map(a=>_("option",{value:a.name},`${a.name}: ${a.about}`))),n=_("input",{type:"number",min:1,value:1}),s=_("input",{type:"number",min:.1,max:100,step:"any",value:1}),r=_("input",{type:"checkbox"}),o=()=>this.call("open",{experiment:e.value,participant:Number(n.value),resume:r.checked,rate:Number(s.value)});It(this.screen,_("h2",{},"Start a session"),Dn("Experiment",e),Dn("Participant",n),Dn("Speed of the trials (1: real time)",s),_("label",{class:"option"},r,"Continue an interrupted session"),_("p",{},_("button",{type:"button",class:"main",onclick:o},"Start")))}showScreen(){let{html:t,questions:e,answers:n}=this.state;this.form=Vp(e,n);let s=_("button",{type:"submit",class:"main"},"Continue"),r=_("form",{onsubmit:o=>this.submit(o)},Hp(t),this.form.element,_("p",{},s));It(this.screen,r)}async submit(t){t.preventDefault();let e=this.form.missing();if(e.length)return Te(`Please answer: ${e.join("; ")}`,"error");let n=this.form.values();if(!(Object.keys(n).length&&!await this.call("answer",{answers:n})))return this.call("next")}showTrial(){this.bar=_("progress",{max:1,value:0,"aria-label":"Progress of the trial"}),It(this.screen,_("h2",{},"Watch the trial"),_("div",{class:"trial"},this.trial.element),this.bar),this.trial.wake()}progress(t){this.bar&&(this.bar.value=t)}showPause(){let e=this.state.waiting==="failed"?`The trial has failed: ${this.state.reason}`:"The experiment is paused.";It(this.screen,_("h2",{},this.participant?"Please wait.":e))}showEnd(){let t=this.state.phase==="done"?"The session is complete. Thank you.":`The session has ended: ${this.state.reason||this.state.phase}`;It(this.screen,_("h2",{},t))}showOperator(){let{state:t}=this;if(!t.open)return It(this.side,_("h2",{},"Operator"),_("p",{class:"note"},"Start a session. A second window for the participant can be opened then."));let e=o=>t.possible.includes(o),n=(o,a,l)=>e(a)?_("button",{type:"button",onclick:()=>this.call(a,l)},o):null,s=t.phase==="pause"&&e("next")?_("button",{type:"button",onclick:()=>this.call("next")},"Continue without this trial"):null,r=t.phase==="done"||t.phase==="aborted";return It(this.side,_("h2",{},`${t.experiment}, participant ${t.participant}`),_("p",{},`State: ${t.phase}${t.reason?` (${t.reason})`:""}`),_("ol",{class:"steps"},t.steps.map((o,a)=>this.step(o,a))),_("div",{class:"row"},n("Pause","pause"),n("Resume","resume"),n("Repeat the trial","repeat"),s),_("div",{class:"row"},e("abort")?_("button",{type:"button",onclick:()=>this.askAbort()},"Abort"):null,_("button",{type:"button",onclick:()=>this.call("leave")},r?"New session":"Leave for now"),_("button",{type:"button",onclick:()=>this.showAnswers()},"Answers")),_("p",{},_("a",{href:this.participantAddress(),target:"_blank",rel:"noopener"},"Window for the participant")),_("p",{class:"note"},`Files: ${t.folder}`))}step(t,e){let{index:n,outcomes:s,phase:r}=this.state,o=r==="done"||e<n,a=`${t.name} (${t.role})${s[e]?`: ${s[e]}`:""}`;return _("li",{"aria-current":e===n&&!o?"step":null,class:o?"over":""},a)}participantAddress(){let t=new URLSearchParams(this.app.address);return t.set("role","participant"),t.set("tab","experiments"),`?window=participant#${t}`}askAbort(){let t=_("input",{type:"text"});De("End the session permanently?",Dn("Reason",t),[["Cancel",()=>!0],["Abort the session",()=>{this.call("abort",{reason:t.value||"operator"})}]])}async showAnswers(){let t=await this.call("answers");if(!t)return;let e=[...new Set(t.flatMap(Object.keys))],n=r=>_("td",{},r==null?"":String(r)),s=_("table",{},_("thead",{},_("tr",{},e.map(r=>_("th",{scope:"col"},r)))),_("tbody",{},t.map(r=>_("tr",{},e.map(o=>n(r[o]))))));De("Answers",t.length?s:_("p",{},"No answers yet."))}},S0={name:"experiments",title:"Experiments",mount(i,t){let e=new ff(i,t);return{tab:e,greet:n=>e.update(n)}}};function On(i,t=()=>{}){let e=i.map(r=>[r,oT(r)]);for(let[,r]of e)r.addEventListener("change",t);return{element:_("div",{class:"form"},e.map(([r,o])=>Dn(r.unit?`${r.label} [${r.unit}]`:r.label,o,r.note))),values:()=>Object.fromEntries(e.map(([r,o])=>[r.name,aT(r,o)]))}}function oT(i){if(i.kind==="choice")return _("select",{name:i.name},i.choices.map(e=>{let[n,s]=Array.isArray(e)?e:[e,e];return _("option",{value:n,selected:n===i.value},s)}));if(i.kind==="switch")return _("input",{name:i.name,type:"checkbox",checked:i.value===!0});if(i.kind==="text")return _("input",{name:i.name,type:"text",value:i.value??""});let t=i.step??(i.kind==="whole"?1:"any");return _("input",{name:i.name,type:"number",value:i.value??"",min:i.low,max:i.high,step:t})}function aT(i,t){return i.kind==="switch"?t.checked:i.kind==="number"||i.kind==="whole"?t.value===""?null:Number(t.value):t.value}var lT="uplot",cT="u-hz",hT="u-vt",uT="u-title",dT="u-wrap",fT="u-under",pT="u-over",mT="u-axis",Er="u-off",gT="u-select",_T="u-cursor-x",yT="u-cursor-y",xT="u-cursor-pt",vT="u-legend",bT="u-live",ST="u-inline",MT="u-series",wT="u-marker",M0="u-label",ET="u-value",Ya="width",Za="height";var w0="bottom",Ro="left",pf="right",If="#000",E0=If+"0",mf="mousemove",T0="mousedown",gf="mouseup",A0="mouseenter",R0="mouseleave",C0="dblclick",TT="resize",AT="scroll",P0="change",Dh="dppxchange",Lf="--",Uo=typeof window<"u",bf=Uo?document:null,Po=Uo?window:null,RT=Uo?navigator:null,Ee,Ch;function Sf(){let i=devicePixelRatio;Ee!=i&&(Ee=i,Ch&&wf(P0,Ch,Sf),Ch=matchMedia(`(min-resolution: ${Ee-.001}dppx) and (max-resolution: ${Ee+.001}dppx)`),Tr(P0,Ch,Sf),Po.dispatchEvent(new CustomEvent(Dh)))}function xi(i,t){if(t!=null){let e=i.classList;!e.contains(t)&&e.add(t)}}function Mf(i,t){let e=i.classList;e.contains(t)&&e.remove(t)}function Ze(i,t,e){i.style[t]=e+"px"}function zi(i,t,e,n){let s=bf.createElement(i);return t!=null&&xi(s,t),e?.insertBefore(s,n),s}function Ai(i,t){return zi("div",i,t)}var I0=new WeakMap;function ns(i,t,e,n,s){let r="translate("+t+"px,"+e+"px)",o=I0.get(i);r!=o&&(i.style.transform=r,I0.set(i,r),t<0||e<0||t>n||e>s?xi(i,Er):Mf(i,Er))}var L0=new WeakMap;function D0(i,t,e){let n=t+e,s=L0.get(i);n!=s&&(L0.set(i,n),i.style.background=t,i.style.borderColor=e)}var N0=new WeakMap;function U0(i,t,e,n){let s=t+""+e,r=N0.get(i);s!=r&&(N0.set(i,s),i.style.height=e+"px",i.style.width=t+"px",i.style.marginLeft=n?-t/2+"px":0,i.style.marginTop=n?-e/2+"px":0)}var Df={passive:!0},CT={...Df,capture:!0};function Tr(i,t,e,n){t.addEventListener(i,e,n?CT:Df)}function wf(i,t,e,n){t.removeEventListener(i,e,Df)}Uo&&Sf();function Hi(i,t,e,n){let s;e=e||0,n=n||t.length-1;let r=n<=2147483647;for(;n-e>1;)s=r?e+n>>1:vi((e+n)/2),t[s]<i?e=s:n=s;return i-t[e]<=t[n]-i?e:n}function c_(i){return(e,n,s)=>{let r=-1,o=-1;for(let a=n;a<=s;a++)if(i(e[a])){r=a;break}for(let a=s;a>=n;a--)if(i(e[a])){o=a;break}return[r,o]}}var h_=i=>i!=null,u_=i=>i!=null&&i>0,Fh=c_(h_),PT=c_(u_);function IT(i,t,e,n=0,s=!1){let r=s?PT:Fh,o=s?u_:h_;[t,e]=r(i,t,e);let a=i[t],l=i[t];if(t>-1)if(n==1)a=i[t],l=i[e];else if(n==-1)a=i[e],l=i[t];else for(let c=t;c<=e;c++){let u=i[c];o(u)&&(u<a?a=u:u>l&&(l=u))}return[a??Be,l??-Be]}function Oh(i,t,e,n){let s=k0(i),r=k0(t);i==t&&(s==-1?(i*=e,t/=e):(i/=e,t*=e));let o=e==10?Ss:d_,a=s==1?vi:Ri,l=r==1?Ri:vi,c=a(o(An(i))),u=l(o(An(t))),d=Io(e,c),h=Io(e,u);return e==10&&(c<0&&(d=ze(d,-c)),u<0&&(h=ze(h,-u))),n||e==2?(i=d*s,t=h*r):(i=g_(i,d),t=kh(t,h)),[i,t]}function Nf(i,t,e,n){let s=Oh(i,t,e,n);return i==0&&(s[0]=0),t==0&&(s[1]=0),s}var Uf=.1,F0={mode:3,pad:Uf},Ja={pad:0,soft:null,mode:0},LT={min:Ja,max:Ja};function Nh(i,t,e,n){return Bh(e)?O0(i,t,e):(Ja.pad=e,Ja.soft=n?0:null,Ja.mode=n?3:0,O0(i,t,LT))}function Se(i,t){return i??t}function DT(i,t,e){for(t=Se(t,0),e=Se(e,i.length-1);t<=e;){if(i[t]!=null)return!0;t++}return!1}function O0(i,t,e){let n=e.min,s=e.max,r=Se(n.pad,0),o=Se(s.pad,0),a=Se(n.hard,-Be),l=Se(s.hard,Be),c=Se(n.soft,Be),u=Se(s.soft,-Be),d=Se(n.mode,0),h=Se(s.mode,0),f=t-i,p=Ss(f),v=ri(An(i),An(t)),m=Ss(v),g=An(m-p);(f<1e-24||g>10)&&(f=0,(i==0||t==0)&&(f=1e-24,d==2&&c!=Be&&(r=0),h==2&&u!=-Be&&(o=0)));let S=f||v||1e3,M=Ss(S),y=Io(10,vi(M)),C=S*(f==0?i==0?.1:1:r),A=ze(g_(i-C,y/10),24),x=i>=c&&(d==1||d==3&&A<=c||d==2&&A>=c)?c:Be,E=ri(a,A<x&&i>=x?x:Gi(x,A)),F=S*(f==0?t==0?.1:1:o),L=ze(kh(t+F,y/10),24),D=t<=u&&(h==1||h==3&&L>=u||h==2&&L<=u)?u:-Be,B=Gi(l,L>D&&t<=D?D:ri(D,L));return E==B&&E==0&&(B=100),[E,B]}var NT=new Intl.NumberFormat(Uo?RT.language:"en-US"),Ff=i=>NT.format(i),bi=Math,Lh=bi.PI,An=bi.abs,vi=bi.floor,Tn=bi.round,Ri=bi.ceil,Gi=bi.min,ri=bi.max,Io=bi.pow,k0=bi.sign,Ss=bi.log10,d_=bi.log2,UT=(i,t=1)=>bi.sinh(i)*t,_f=(i,t=1)=>bi.asinh(i/t),Be=1/0;function B0(i){return(Ss((i^i>>31)-(i>>31))|0)+1}function Ef(i,t,e){return Gi(ri(i,t),e)}function f_(i){return typeof i=="function"}function ye(i){return f_(i)?i:()=>i}var FT=()=>{},p_=i=>i,m_=(i,t)=>t,OT=i=>null,z0=i=>!0,H0=(i,t)=>i==t,kT=/\.\d*?(?=9{6,}|0{6,})/gm,Ar=i=>{if(y_(i)||ir.has(i))return i;let t=`${i}`,e=t.match(kT);if(e==null)return i;let n=e[0].length-1;if(t.indexOf("e-")!=-1){let[s,r]=t.split("e");return+`${Ar(s)}e${r}`}return ze(i,n)};function Mr(i,t){return Ar(ze(Ar(i/t))*t)}function kh(i,t){return Ar(Ri(Ar(i/t))*t)}function g_(i,t){return Ar(vi(Ar(i/t))*t)}function ze(i,t=0){if(y_(i))return i;let e=10**t,n=i*e*(1+Number.EPSILON);return Tn(n)/e}var ir=new Map;function __(i){return((""+i).split(".")[1]||"").length}function Qa(i,t,e,n){let s=[],r=n.map(__);for(let o=t;o<e;o++){let a=An(o),l=ze(Io(i,o),a);for(let c=0;c<n.length;c++){let u=i==10?+`${n[c]}e${o}`:n[c]*l,d=(o>=0?0:a)+(o>=r[c]?0:r[c]),h=i==10?u:ze(u,d);s.push(h),ir.set(h,d)}}return s}var ja={},Of=[],Lo=[null,null],nr=Array.isArray,y_=Number.isInteger,BT=i=>i===void 0;function G0(i){return typeof i=="string"}function Bh(i){let t=!1;if(i!=null){let e=i.constructor;t=e==null||e==Object}return t}function zT(i){return i!=null&&typeof i=="object"}var HT=Object.getPrototypeOf(Uint8Array),x_="__proto__";function Do(i,t=Bh){let e;if(nr(i)){let n=i.find(s=>s!=null);if(nr(n)||t(n)){e=Array(i.length);for(let s=0;s<i.length;s++)e[s]=Do(i[s],t)}else e=i.slice()}else if(i instanceof HT)e=i.slice();else if(t(i)){e={};for(let n in i)n!=x_&&(e[n]=Do(i[n],t))}else e=i;return e}function yn(i){let t=arguments;for(let e=1;e<t.length;e++){let n=t[e];for(let s in n)s!=x_&&(Bh(i[s])?yn(i[s],Do(n[s])):i[s]=Do(n[s]))}return i}var GT=0,VT=1,WT=2;function XT(i,t,e){for(let n=0,s,r=-1;n<t.length;n++){let o=t[n];if(o>r){for(s=o-1;s>=0&&i[s]==null;)i[s--]=null;for(s=o+1;s<e&&i[s]==null;)i[r=s++]=null}}}function $T(i,t){if(ZT(i)){let o=i[0].slice();for(let a=1;a<i.length;a++)o.push(...i[a].slice(1));return KT(o[0])||(o=YT(o)),o}let e=new Set;for(let o=0;o<i.length;o++){let l=i[o][0],c=l.length;for(let u=0;u<c;u++)e.add(l[u])}let n=[Array.from(e).sort((o,a)=>o-a)],s=n[0].length,r=new Map;for(let o=0;o<s;o++)r.set(n[0][o],o);for(let o=0;o<i.length;o++){let a=i[o],l=a[0];for(let c=1;c<a.length;c++){let u=a[c],d=Array(s).fill(void 0),h=t?t[o][c]:VT,f=[];for(let p=0;p<u.length;p++){let v=u[p],m=r.get(l[p]);v===null?h!=GT&&(d[m]=v,h==WT&&f.push(m)):d[m]=v}XT(d,f,s),n.push(d)}}return n}var qT=typeof queueMicrotask>"u"?i=>Promise.resolve().then(i):queueMicrotask;function YT(i){let t=i[0],e=t.length,n=Array(e);for(let r=0;r<n.length;r++)n[r]=r;n.sort((r,o)=>t[r]-t[o]);let s=[];for(let r=0;r<i.length;r++){let o=i[r],a=Array(e);for(let l=0;l<e;l++)a[l]=o[n[l]];s.push(a)}return s}function ZT(i){let t=i[0][0],e=t.length;for(let n=1;n<i.length;n++){let s=i[n][0];if(s.length!=e)return!1;if(s!=t){for(let r=0;r<e;r++)if(s[r]!=t[r])return!1}}return!0}function KT(i,t=100){let e=i.length;if(e<=1)return!0;let n=0,s=e-1;for(;n<=s&&i[n]==null;)n++;for(;s>=n&&i[s]==null;)s--;if(s<=n)return!0;let r=ri(1,vi((s-n+1)/t));for(let o=i[n],a=n+r;a<=s;a+=r){let l=i[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var v_=["January","February","March","April","May","June","July","August","September","October","November","December"],b_=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function S_(i){return i.slice(0,3)}var JT=b_.map(S_),jT=v_.map(S_),QT={MMMM:v_,MMM:jT,WWWW:b_,WWW:JT};function qa(i){return(i<10?"0":"")+i}function t1(i){return(i<10?"00":i<100?"0":"")+i}var e1={YYYY:i=>i.getFullYear(),YY:i=>(i.getFullYear()+"").slice(2),MMMM:(i,t)=>t.MMMM[i.getMonth()],MMM:(i,t)=>t.MMM[i.getMonth()],MM:i=>qa(i.getMonth()+1),M:i=>i.getMonth()+1,DD:i=>qa(i.getDate()),D:i=>i.getDate(),WWWW:(i,t)=>t.WWWW[i.getDay()],WWW:(i,t)=>t.WWW[i.getDay()],HH:i=>qa(i.getHours()),H:i=>i.getHours(),h:i=>{let t=i.getHours();return t==0?12:t>12?t-12:t},AA:i=>i.getHours()>=12?"PM":"AM",aa:i=>i.getHours()>=12?"pm":"am",a:i=>i.getHours()>=12?"p":"a",mm:i=>qa(i.getMinutes()),m:i=>i.getMinutes(),ss:i=>qa(i.getSeconds()),s:i=>i.getSeconds(),fff:i=>t1(i.getMilliseconds())};function kf(i,t){t=t||QT;let e=[],n=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=n.exec(i);)e.push(s[0][0]=="{"?e1[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<e.length;a++)o+=typeof e[a]=="string"?e[a]:e[a](r,t);return o}}var n1=new Intl.DateTimeFormat().resolvedOptions().timeZone;function i1(i,t){let e;return t=="UTC"||t=="Etc/UTC"?e=new Date(+i+i.getTimezoneOffset()*6e4):t==n1?e=i:(e=new Date(i.toLocaleString("en-US",{timeZone:t})),e.setMilliseconds(i.getMilliseconds())),e}var M_=i=>i%1==0,Uh=[1,2,2.5,5],s1=Qa(10,-32,0,Uh),w_=Qa(10,0,32,Uh),r1=w_.filter(M_),wr=s1.concat(w_),Bf=`
`,E_="{YYYY}",V0=Bf+E_,T_="{M}/{D}",Ka=Bf+T_,Ph=Ka+"/{YY}",A_="{aa}",o1="{h}:{mm}",Co=o1+A_,W0=Bf+Co,X0=":{ss}",Ce=null;function R_(i){let t=i*1e3,e=t*60,n=e*60,s=n*24,r=s*30,o=s*365,l=(i==1?Qa(10,0,3,Uh).filter(M_):Qa(10,-3,0,Uh)).concat([t,t*5,t*10,t*15,t*30,e,e*5,e*10,e*15,e*30,n,n*2,n*3,n*4,n*6,n*8,n*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,E_,Ce,Ce,Ce,Ce,Ce,Ce,1],[s*28,"{MMM}",V0,Ce,Ce,Ce,Ce,Ce,1],[s,T_,V0,Ce,Ce,Ce,Ce,Ce,1],[n,"{h}"+A_,Ph,Ce,Ka,Ce,Ce,Ce,1],[e,Co,Ph,Ce,Ka,Ce,Ce,Ce,1],[t,X0,Ph+" "+Co,Ce,Ka+" "+Co,Ce,W0,Ce,1],[i,X0+".{fff}",Ph+" "+Co,Ce,Ka+" "+Co,Ce,W0,Ce,1]];function u(d){return(h,f,p,v,m,g)=>{let S=[],M=m>=o,y=m>=r&&m<o,C=d(p),A=ze(C*i,3),x=yf(C.getFullYear(),M?0:C.getMonth(),y||M?1:C.getDate()),E=ze(x*i,3);if(y||M){let F=y?m/r:0,L=M?m/o:0,D=A==E?A:ze(yf(x.getFullYear()+L,x.getMonth()+F,1)*i,3),B=new Date(Tn(D/i)),G=B.getFullYear(),N=B.getMonth();for(let W=0;D<=v;W++){let q=yf(G+L*W,N+F*W,1),V=q-d(ze(q*i,3));D=ze((+q+V)*i,3),D<=v&&S.push(D)}}else{let F=m>=s?s:m,L=vi(p)-vi(A),D=E+L+kh(A-E,F);S.push(D);let B=d(D),G=B.getHours()+B.getMinutes()/e+B.getSeconds()/n,N=m/n,W=h.axes[f]._space,q=g/W;for(;D=ze(D+m,i==1?0:3),!(D>v);)if(N>1){let V=vi(ze(G+N,6))%24,j=d(D).getHours()-V;j>1&&(j=-1),D-=j*n,G=(G+N)%24;let et=S[S.length-1];ze((D-et)/m,3)*q>=.7&&S.push(D)}else S.push(D)}return S}}return[l,c,u]}var[a1,l1,c1]=R_(1),[h1,u1,d1]=R_(.001);Qa(2,-53,53,[1]);function $0(i,t){return i.map(e=>e.map((n,s)=>s==0||s==8||n==null?n:t(s==1||e[8]==0?n:e[1]+n)))}function q0(i,t){return(e,n,s,r,o)=>{let a=t.find(p=>o>=p[0])||t[t.length-1],l,c,u,d,h,f;return n.map(p=>{let v=i(p),m=v.getFullYear(),g=v.getMonth(),S=v.getDate(),M=v.getHours(),y=v.getMinutes(),C=v.getSeconds(),A=m!=l&&a[2]||g!=c&&a[3]||S!=u&&a[4]||M!=d&&a[5]||y!=h&&a[6]||C!=f&&a[7]||a[1];return l=m,c=g,u=S,d=M,h=y,f=C,A(v)})}}function f1(i,t){let e=kf(t);return(n,s,r,o,a)=>s.map(l=>e(i(l)))}function yf(i,t,e){return new Date(i,t,e)}function Y0(i,t){return t(i)}var p1="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function Z0(i,t){return(e,n,s,r)=>r==null?Lf:t(i(n))}function m1(i,t){let e=i.series[t];return e.width?e.stroke(i,t):e.points.width?e.points.stroke(i,t):null}function g1(i,t){return i.series[t].fill(i,t)}var _1={show:!0,live:!0,isolate:!1,mount:FT,markers:{show:!0,width:2,stroke:m1,fill:g1,dash:"solid"},idx:null,idxs:null,values:[]};function y1(i,t){let e=i.cursor.points,n=Ai(),s=e.size(i,t);Ze(n,Ya,s),Ze(n,Za,s);let r=s/-2;Ze(n,"marginLeft",r),Ze(n,"marginTop",r);let o=e.width(i,t,s);return o&&Ze(n,"borderWidth",o),n}function x1(i,t){let e=i.series[t].points;return e._fill||e._stroke}function v1(i,t){let e=i.series[t].points;return e._stroke||e._fill}function b1(i,t){return i.series[t].points.size}var xf=[0,0];function S1(i,t,e){return xf[0]=t,xf[1]=e,xf}function Ih(i,t,e,n=!0){return s=>{s.button==0&&(!n||s.target==t)&&e(s)}}function vf(i,t,e,n=!0){return s=>{(!n||s.target==t)&&e(s)}}var M1={show:!0,x:!0,y:!0,lock:!1,move:S1,points:{one:!1,show:y1,size:b1,width:0,stroke:v1,fill:x1},bind:{mousedown:Ih,mouseup:Ih,click:Ih,dblclick:Ih,mousemove:vf,mouseleave:vf,mouseenter:vf},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(i,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(i,t,e,n,s)=>n-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},C_={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},zf=yn({},C_,{filter:m_}),P_=yn({},zf,{size:10}),I_=yn({},C_,{show:!1}),Hf='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',L_="bold "+Hf,D_=1.5,K0={show:!0,scale:"x",stroke:If,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:L_,side:2,grid:zf,ticks:P_,border:I_,font:Hf,lineGap:D_,rotate:0},w1="Value",E1="Time",J0={show:!0,scale:"x",auto:!1,sorted:1,min:Be,max:-Be,idxs:[]};function T1(i,t,e,n,s){return t.map(r=>r==null?"":Ff(r))}function A1(i,t,e,n,s,r,o){let a=[],l=ir.get(s)||0;e=o?e:ze(kh(e,s),l);for(let c=e;c<=n;c=ze(c+s,l))a.push(Object.is(c,-0)?0:c);return a}function Tf(i,t,e,n,s,r,o){let a=[],l=i.scales[i.axes[t].scale].log,c=l==10?Ss:d_,u=vi(c(e));s=Io(l,u),l==10&&(s=wr[Hi(s,wr)]);let d=e,h=s*l;l==10&&(h=wr[Hi(h,wr)]);do a.push(d),d=d+s,l==10&&!ir.has(d)&&(d=ze(d,ir.get(s))),d>=h&&(s=d,h=s*l,l==10&&(h=wr[Hi(h,wr)]));while(d<=n);return a}function R1(i,t,e,n,s,r,o){let l=i.scales[i.axes[t].scale].asinh,c=n>l?Tf(i,t,ri(l,e),n,s):[l],u=n>=0&&e<=0?[0]:[];return(e<-l?Tf(i,t,ri(l,-n),-e,s):[l]).reverse().map(h=>-h).concat(u,c)}var N_=/./,C1=/[12357]/,P1=/[125]/,j0=/1/,Af=(i,t,e,n)=>i.map((s,r)=>t==4&&s==0||r%n==0&&e.test(s.toExponential()[s<0?1:0])?s:null);function I1(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=i.scales[o],l=i.valToPos,c=r._space,u=l(10,o),d=l(9,o)-u>=c?N_:l(7,o)-u>=c?C1:l(5,o)-u>=c?P1:j0;if(d==j0){let h=An(l(1,o)-u);if(h<c)return Af(t.slice().reverse(),a.distr,d,Ri(c/h)).reverse()}return Af(t,a.distr,d,1)}function L1(i,t,e,n,s){let r=i.axes[e],o=r.scale,a=r._space,l=i.valToPos,c=An(l(1,o)-l(2,o));return c<a?Af(t.slice().reverse(),3,N_,Ri(a/c)).reverse():t}function D1(i,t,e,n){return n==null?Lf:t==null?"":Ff(t)}var Q0={show:!0,scale:"y",stroke:If,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:L_,side:3,grid:zf,ticks:P_,border:I_,font:Hf,lineGap:D_,rotate:0};function N1(i,t){let e=3+(i||1)*2;return ze(e*t,3)}function U1(i,t){let{scale:e,idxs:n}=i.series[0],s=i._data[0],r=i.valToPos(s[n[0]],e,!0),o=i.valToPos(s[n[1]],e,!0),a=An(o-r),l=i.series[t],c=a/(l.points.space*Ee);return n[1]-n[0]<=c}var t_={scale:null,auto:!0,sorted:0,min:Be,max:-Be},U_=(i,t,e,n,s)=>s,e_={show:!0,auto:!0,sorted:0,gaps:U_,alpha:1,facets:[yn({},t_,{scale:"x"}),yn({},t_,{scale:"y"})]},n_={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:U_,alpha:1,points:{show:U1,filter:null},values:null,min:Be,max:-Be,idxs:[],path:null,clip:null};function F1(i,t,e,n,s){return e/10}var F_={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},O1=yn({},F_,{time:!1,ori:1}),i_={};function O_(i,t){let e=i_[i];return e||(e={key:i,plots:[],sub(n){e.plots.push(n)},unsub(n){e.plots=e.plots.filter(s=>s!=n)},pub(n,s,r,o,a,l,c){for(let u=0;u<e.plots.length;u++)e.plots[u]!=s&&e.plots[u].pub(n,s,r,o,a,l,c)}},i!=null&&(i_[i]=e)),e}var No=1,Rf=2;function Rr(i,t,e){let n=i.mode,s=i.series[t],r=n==2?i._data[t]:i._data,o=i.scales,a=i.bbox,l=r[0],c=n==2?r[1]:r[t],u=n==2?o[s.facets[0].scale]:o[i.series[0].scale],d=n==2?o[s.facets[1].scale]:o[s.scale],h=a.left,f=a.top,p=a.width,v=a.height,m=i.valToPosH,g=i.valToPosV;return u.ori==0?e(s,l,c,u,d,m,g,h,f,p,v,Hh,Fo,Vh,B_,H_):e(s,l,c,u,d,g,m,f,h,v,p,Gh,Oo,Wf,z_,G_)}function Gf(i,t){let e=0,n=0,s=Se(i.bands,Of);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==t?e=o.dir:o.series[1]==t&&(o.dir==1?n|=1:n|=2)}return[e,n==1?-1:n==2?1:n==3?2:0]}function k1(i,t,e,n,s){let r=i.mode,o=i.series[t],a=r==2?o.facets[1].scale:o.scale,l=i.scales[a];return s==-1?l.min:s==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function Ms(i,t,e,n,s,r){return Rr(i,t,(o,a,l,c,u,d,h,f,p,v,m)=>{let g=o.pxRound,S=c.dir*(c.ori==0?1:-1),M=c.ori==0?Fo:Oo,y,C;S==1?(y=e,C=n):(y=n,C=e);let A=g(d(a[y],c,v,f)),x=g(h(l[y],u,m,p)),E=g(d(a[C],c,v,f)),F=g(h(r==1?u.max:u.min,u,m,p)),L=new Path2D(s);return M(L,E,F),M(L,A,F),M(L,A,x),L})}function zh(i,t,e,n,s,r){let o=null;if(i.length>0){o=new Path2D;let a=t==0?Vh:Wf,l=e;for(let d=0;d<i.length;d++){let h=i[d];if(h[1]>h[0]){let f=h[0]-l;f>0&&a(o,l,n,f,n+r),l=h[1]}}let c=e+s-l,u=10;c>0&&a(o,l,n-u/2,c,n+r+u)}return o}function B1(i,t,e){let n=i[i.length-1];n&&n[0]==t?n[1]=e:i.push([t,e])}function Vf(i,t,e,n,s,r,o){let a=[],l=i.length;for(let c=s==1?e:n;c>=e&&c<=n;c+=s)if(t[c]===null){let d=c,h=c;if(s==1)for(;++c<=n&&t[c]===null;)h=c;else for(;--c>=e&&t[c]===null;)h=c;let f=r(i[d]),p=h==d?f:r(i[h]),v=d-s;f=o<=0&&v>=0&&v<l?r(i[v]):f;let g=h+s;p=o>=0&&g>=0&&g<l?r(i[g]):p,p>=f&&a.push([f,p])}return a}function s_(i){return i==0?p_:i==1?Tn:t=>Mr(t,i)}function k_(i){let t=i==0?Hh:Gh,e=i==0?(s,r,o,a,l,c)=>{s.arcTo(r,o,a,l,c)}:(s,r,o,a,l,c)=>{s.arcTo(o,r,l,a,c)},n=i==0?(s,r,o,a,l)=>{s.rect(r,o,a,l)}:(s,r,o,a,l)=>{s.rect(o,r,l,a)};return(s,r,o,a,l,c=0,u=0)=>{c==0&&u==0?n(s,r,o,a,l):(c=Gi(c,a/2,l/2),u=Gi(u,a/2,l/2),t(s,r+c,o),e(s,r+a,o,r+a,o+l,c),e(s,r+a,o+l,r,o+l,u),e(s,r,o+l,r,o,u),e(s,r,o,r+a,o,c),s.closePath())}}var Hh=(i,t,e)=>{i.moveTo(t,e)},Gh=(i,t,e)=>{i.moveTo(e,t)},Fo=(i,t,e)=>{i.lineTo(t,e)},Oo=(i,t,e)=>{i.lineTo(e,t)},Vh=k_(0),Wf=k_(1),B_=(i,t,e,n,s,r)=>{i.arc(t,e,n,s,r)},z_=(i,t,e,n,s,r)=>{i.arc(e,t,n,s,r)},H_=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(t,e,n,s,r,o)},G_=(i,t,e,n,s,r,o)=>{i.bezierCurveTo(e,t,s,n,o,r)};function V_(i){return(t,e,n,s,r)=>Rr(t,e,(o,a,l,c,u,d,h,f,p,v,m)=>{let{pxRound:g,points:S}=o,M,y;c.ori==0?(M=Hh,y=B_):(M=Gh,y=z_);let C=ze(S.width*Ee,3),A=(S.size-S.width)/2*Ee,x=ze(A*2,3),E=new Path2D,F=new Path2D,{left:L,top:D,width:B,height:G}=t.bbox;Vh(F,L-x,D-x,B+x*2,G+x*2);let N=W=>{if(l[W]!=null){let q=g(d(a[W],c,v,f)),V=g(h(l[W],u,m,p));M(E,q+A,V),y(E,q,V,A,0,Lh*2)}};if(r)r.forEach(N);else for(let W=n;W<=s;W++)N(W);return{stroke:C>0?E:null,fill:E,clip:F,flags:No|Rf}})}function W_(i){return(t,e,n,s,r,o)=>{n!=s&&(r!=n&&o!=n&&i(t,e,n),r!=s&&o!=s&&i(t,e,s),i(t,e,o))}}var z1=W_(Fo),H1=W_(Oo);function X_(i){let t=Se(i?.alignGaps,0);return(e,n,s,r)=>Rr(e,n,(o,a,l,c,u,d,h,f,p,v,m)=>{[s,r]=Fh(l,s,r);let g=o.pxRound,S=G=>g(d(G,c,v,f)),M=G=>g(h(G,u,m,p)),y,C;c.ori==0?(y=Fo,C=z1):(y=Oo,C=H1);let A=c.dir*(c.ori==0?1:-1),x={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:No},E=x.stroke,F=!1;if(r-s>=v*4){let G=ut=>e.posToVal(ut,c.key,!0),N=null,W=null,q,V,lt,Z=S(a[A==1?s:r]),j=S(a[s]),et=S(a[r]),dt=G(A==1?j+1:et-1);for(let ut=A==1?s:r;ut>=s&&ut<=r;ut+=A){let tt=a[ut],yt=(A==1?tt<dt:tt>dt)?Z:S(tt),At=l[ut];yt==Z?At!=null?(V=At,N==null?(y(E,yt,M(V)),q=N=W=V):V<N?N=V:V>W&&(W=V)):At===null&&(F=!0):(N!=null&&C(E,Z,M(N),M(W),M(q),M(V)),At!=null?(V=At,y(E,yt,M(V)),N=W=q=V):(N=W=null,At===null&&(F=!0)),Z=yt,dt=G(Z+A))}N!=null&&N!=W&&lt!=Z&&C(E,Z,M(N),M(W),M(q),M(V))}else for(let G=A==1?s:r;G>=s&&G<=r;G+=A){let N=l[G];N===null?F=!0:N!=null&&y(E,S(a[G]),M(N))}let[D,B]=Gf(e,n);if(o.fill!=null||D!=0){let G=x.fill=new Path2D(E),N=o.fillTo(e,n,o.min,o.max,D),W=M(N),q=S(a[s]),V=S(a[r]);A==-1&&([V,q]=[q,V]),y(G,V,W),y(G,q,W)}if(!o.spanGaps){let G=[];F&&G.push(...Vf(a,l,s,r,A,S,t)),x.gaps=G=o.gaps(e,n,s,r,G),x.clip=zh(G,c.ori,f,p,v,m)}return B!=0&&(x.band=B==2?[Ms(e,n,s,r,E,-1),Ms(e,n,s,r,E,1)]:Ms(e,n,s,r,E,B)),x})}function G1(i){let t=Se(i.align,1),e=Se(i.ascDesc,!1),n=Se(i.alignGaps,0),s=Se(i.extend,!1);return(r,o,a,l)=>Rr(r,o,(c,u,d,h,f,p,v,m,g,S,M)=>{[a,l]=Fh(d,a,l);let y=c.pxRound,{left:C,width:A}=r.bbox,x=j=>y(p(j,h,S,m)),E=j=>y(v(j,f,M,g)),F=h.ori==0?Fo:Oo,L={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:No},D=L.stroke,B=h.dir*(h.ori==0?1:-1),G=E(d[B==1?a:l]),N=x(u[B==1?a:l]),W=N,q=N;s&&t==-1&&(q=C,F(D,q,G)),F(D,N,G);for(let j=B==1?a:l;j>=a&&j<=l;j+=B){let et=d[j];if(et==null)continue;let dt=x(u[j]),ut=E(et);t==1?F(D,dt,G):F(D,W,ut),F(D,dt,ut),G=ut,W=dt}let V=W;s&&t==1&&(V=C+A,F(D,V,G));let[lt,Z]=Gf(r,o);if(c.fill!=null||lt!=0){let j=L.fill=new Path2D(D),et=c.fillTo(r,o,c.min,c.max,lt),dt=E(et);F(j,V,dt),F(j,q,dt)}if(!c.spanGaps){let j=[];j.push(...Vf(u,d,a,l,B,x,n));let et=c.width*Ee/2,dt=e||t==1?et:-et,ut=e||t==-1?-et:et;j.forEach(tt=>{tt[0]+=dt,tt[1]+=ut}),L.gaps=j=c.gaps(r,o,a,l,j),L.clip=zh(j,h.ori,m,g,S,M)}return Z!=0&&(L.band=Z==2?[Ms(r,o,a,l,D,-1),Ms(r,o,a,l,D,1)]:Ms(r,o,a,l,D,Z)),L})}function r_(i,t,e,n,s,r,o=Be){if(i.length>1){let a=null;for(let l=0,c=1/0;l<i.length;l++)if(t[l]!==void 0){if(a!=null){let u=An(i[l]-i[a]);u<c&&(c=u,o=An(e(i[l],n,s,r)-e(i[a],n,s,r)))}a=l}}return o}function V1(i){i=i||ja;let t=Se(i.size,[.6,Be,1]),e=i.align||0,n=i.gap||0,s=i.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=ye(s),o=1-t[0],a=Se(t[1],Be),l=Se(t[2],1),c=Se(i.disp,ja),u=Se(i.each,f=>{}),{fill:d,stroke:h}=c;return(f,p,v,m)=>Rr(f,p,(g,S,M,y,C,A,x,E,F,L,D)=>{let B=g.pxRound,G=e,N=n*Ee,W=a*Ee,q=l*Ee,V,lt;y.ori==0?[V,lt]=r(f,p):[lt,V]=r(f,p);let Z=y.dir*(y.ori==0?1:-1),j=y.ori==0?Vh:Wf,et=y.ori==0?u:(Ct,Kt,oe,Mt,Fe,Ht,qt)=>{u(Ct,Kt,oe,Fe,Mt,qt,Ht)},dt=Se(f.bands,Of).find(Ct=>Ct.series[0]==p),ut=dt!=null?dt.dir:0,tt=g.fillTo(f,p,g.min,g.max,ut),mt=B(x(tt,C,D,F)),yt,At,St,Xt=L,re=B(g.width*Ee),Gt=!1,ue=null,le=null,ie=null,Ke=null;d!=null&&(re==0||h!=null)&&(Gt=!0,ue=d.values(f,p,v,m),le=new Map,new Set(ue).forEach(Ct=>{Ct!=null&&le.set(Ct,new Path2D)}),re>0&&(ie=h.values(f,p,v,m),Ke=new Map,new Set(ie).forEach(Ct=>{Ct!=null&&Ke.set(Ct,new Path2D)})));let{x0:He,size:un}=c;if(He!=null&&un!=null){G=1,S=He.values(f,p,v,m),He.unit==2&&(S=S.map(oe=>f.posToVal(E+oe*L,y.key,!0)));let Ct=un.values(f,p,v,m);un.unit==2?At=Ct[0]*L:At=A(Ct[0],y,L,E)-A(0,y,L,E),Xt=r_(S,M,A,y,L,E,Xt),St=Xt-At+N}else Xt=r_(S,M,A,y,L,E,Xt),St=Xt*o+N,At=Xt-St;St<1&&(St=0),re>=At/2&&(re=0),St<5&&(B=p_);let Ne=St>0,Rn=Xt-St-(Ne?re:0);At=B(Ef(Rn,q,W)),yt=(G==0?At/2:G==Z?0:At)-G*Z*((G==0?N/2:0)+(Ne?re/2:0));let xe={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},xn=Gt?null:new Path2D,nn=null;if(dt!=null)nn=f.data[dt.series[1]];else{let{y0:Ct,y1:Kt}=c;Ct!=null&&Kt!=null&&(M=Kt.values(f,p,v,m),nn=Ct.values(f,p,v,m))}let dn=V*At,k=lt*At;for(let Ct=Z==1?v:m;Ct>=v&&Ct<=m;Ct+=Z){let Kt=M[Ct];if(Kt==null)continue;if(nn!=null){let $=nn[Ct]??0;if(Kt-$==0)continue;mt=x($,C,D,F)}let oe=y.distr!=2||c!=null?S[Ct]:Ct,Mt=A(oe,y,L,E),Fe=x(Se(Kt,tt),C,D,F),Ht=B(Mt-yt),qt=B(ri(Fe,mt)),P=B(Gi(Fe,mt)),w=qt-P;if(Kt!=null){let $=Kt<0?k:dn,ht=Kt<0?dn:k;Gt?(re>0&&ie[Ct]!=null&&j(Ke.get(ie[Ct]),Ht,P+vi(re/2),At,ri(0,w-re),$,ht),ue[Ct]!=null&&j(le.get(ue[Ct]),Ht,P+vi(re/2),At,ri(0,w-re),$,ht)):j(xn,Ht,P+vi(re/2),At,ri(0,w-re),$,ht),et(f,p,Ct,Ht-re/2,P,At+re,w)}}return re>0?xe.stroke=Gt?Ke:xn:Gt||(xe._fill=g.width==0?g._fill:g._stroke??g._fill,xe.width=0),xe.fill=Gt?le:xn,xe})}function W1(i,t){let e=Se(t?.alignGaps,0);return(n,s,r,o)=>Rr(n,s,(a,l,c,u,d,h,f,p,v,m,g)=>{[r,o]=Fh(c,r,o);let S=a.pxRound,M=V=>S(h(V,u,m,p)),y=V=>S(f(V,d,g,v)),C,A,x;u.ori==0?(C=Hh,x=Fo,A=H_):(C=Gh,x=Oo,A=G_);let E=u.dir*(u.ori==0?1:-1),F=M(l[E==1?r:o]),L=F,D=[],B=[];for(let V=E==1?r:o;V>=r&&V<=o;V+=E)if(c[V]!=null){let Z=l[V],j=M(Z);D.push(L=j),B.push(y(c[V]))}let G={stroke:i(D,B,C,x,A,S),fill:null,clip:null,band:null,gaps:null,flags:No},N=G.stroke,[W,q]=Gf(n,s);if(a.fill!=null||W!=0){let V=G.fill=new Path2D(N),lt=a.fillTo(n,s,a.min,a.max,W),Z=y(lt);x(V,L,Z),x(V,F,Z)}if(!a.spanGaps){let V=[];V.push(...Vf(l,c,r,o,E,M,e)),G.gaps=V=a.gaps(n,s,r,o,V),G.clip=zh(V,u.ori,p,v,m,g)}return q!=0&&(G.band=q==2?[Ms(n,s,r,o,N,-1),Ms(n,s,r,o,N,1)]:Ms(n,s,r,o,N,q)),G})}function X1(i){return W1($1,i)}function $1(i,t,e,n,s,r){let o=i.length;if(o<2)return null;let a=new Path2D;if(e(a,i[0],t[0]),o==2)n(a,i[1],t[1]);else{let l=Array(o),c=Array(o-1),u=Array(o-1),d=Array(o-1);for(let h=0;h<o-1;h++)u[h]=t[h+1]-t[h],d[h]=i[h+1]-i[h],c[h]=u[h]/d[h];l[0]=c[0];for(let h=1;h<o-1;h++)c[h]===0||c[h-1]===0||c[h-1]>0!=c[h]>0?l[h]=0:(l[h]=3*(d[h-1]+d[h])/((2*d[h]+d[h-1])/c[h-1]+(d[h]+2*d[h-1])/c[h]),isFinite(l[h])||(l[h]=0));l[o-1]=c[o-2];for(let h=0;h<o-1;h++)s(a,i[h]+d[h]/3,t[h]+l[h]*d[h]/3,i[h+1]-d[h]/3,t[h+1]-l[h+1]*d[h]/3,i[h+1],t[h+1])}return a}var Cf=new Set;function o_(){for(let i of Cf)i.syncRect(!0)}Uo&&(Tr(TT,Po,o_),Tr(AT,Po,o_,!0),Tr(Dh,Po,()=>{Hn.pxRatio=Ee}));var q1=X_(),Y1=V_();function a_(i,t,e,n){return(n?[i[0],i[1]].concat(i.slice(2)):[i[0]].concat(i.slice(1))).map((r,o)=>Pf(r,o,t,e))}function Z1(i,t){return i.map((e,n)=>n==0?{}:yn({},t,e))}function Pf(i,t,e,n){return yn({},t==0?e:n,i)}function $_(i,t,e){return t==null?Lo:[t,e]}var K1=$_;function J1(i,t,e){return t==null?Lo:Nh(t,e,Uf,!0)}function q_(i,t,e,n){return t==null?Lo:Oh(t,e,i.scales[n].log,!1)}var j1=q_;function Y_(i,t,e,n){return t==null?Lo:Nf(t,e,i.scales[n].log,!1)}var Q1=Y_;function tA(i,t,e,n,s){let r=ri(B0(i),B0(t)),o=t-i,a=Hi(s/n*o,e);do{let l=e[a],c=n*l/o;if(c>=s&&r+(l<5?ir.get(l):0)<=17)return[l,c]}while(++a<e.length);return[0,0]}function l_(i){let t,e;return i=i.replace(/(\d+)px/,(n,s)=>(t=Tn((e=+s)*Ee))+"px"),[i,t,e]}function eA(i){i.show&&[i.font,i.labelFont].forEach(t=>{let e=ze(t[2]*Ee,1);t[0]=t[0].replace(/[0-9.]+px/,e+"px"),t[1]=e})}function Hn(i,t,e){let n={mode:Se(i.mode,1)},s=n.mode;function r(b,T,I,U){let X=T.valToPct(b);return U+I*(T.dir==-1?1-X:X)}function o(b,T,I,U){let X=T.valToPct(b);return U+I*(T.dir==-1?X:1-X)}function a(b,T,I,U){return T.ori==0?r(b,T,I,U):o(b,T,I,U)}n.valToPosH=r,n.valToPosV=o;let l=!1;n.status=0;let c=n.root=Ai(lT);if(i.id!=null&&(c.id=i.id),xi(c,i.class),i.title){let b=Ai(uT,c);b.textContent=i.title}let u=zi("canvas"),d=n.ctx=u.getContext("2d"),h=Ai(dT,c);Tr("click",h,b=>{b.target===p&&(Xe!=Fr||Je!=Or)&&Bn.click(n,b)},!0);let f=n.under=Ai(fT,h);h.appendChild(u);let p=n.over=Ai(pT,h);i=Do(i);let v=+Se(i.pxAlign,1),m=s_(v);(i.plugins||[]).forEach(b=>{b.opts&&(i=b.opts(n,i)||i)});let g=i.ms||.001,S=n.series=s==1?a_(i.series||[],J0,n_,!1):Z1(i.series||[null],e_),M=n.axes=a_(i.axes||[],K0,Q0,!0),y=n.scales={},C=n.bands=i.bands||[];C.forEach(b=>{b.fill=ye(b.fill||null),b.dir=Se(b.dir,-1)});let A=s==2?S[1].facets[0].scale:S[0].scale,x={axes:as,series:fe},E=(i.drawOrder||["axes","series"]).map(b=>x[b]);function F(b){let T=b.distr==3?I=>Ss(I>0?I:b.clamp(n,I,b.min,b.max,b.key)):b.distr==4?I=>_f(I,b.asinh):b.distr==100?I=>b.fwd(I):I=>I;return I=>{let U=T(I),{_min:X,_max:J}=b,at=J-X;return(U-X)/at}}function L(b){let T=y[b];if(T==null){let I=(i.scales||ja)[b]||ja;if(I.from!=null){L(I.from);let U=yn({},y[I.from],I,{key:b});U.valToPct=F(U),y[b]=U}else{T=y[b]=yn({},b==A?F_:O1,I),T.key=b;let U=T.time,X=T.range,J=nr(X);if((b!=A||s==2&&!U)&&(J&&(X[0]==null||X[1]==null)&&(X={min:X[0]==null?F0:{mode:1,hard:X[0],soft:X[0]},max:X[1]==null?F0:{mode:1,hard:X[1],soft:X[1]}},J=!1),!J&&Bh(X))){let at=X;X=(ft,vt,Nt)=>vt==null?Lo:Nh(vt,Nt,at)}T.range=ye(X||(U?K1:b==A?T.distr==3?j1:T.distr==4?Q1:$_:T.distr==3?q_:T.distr==4?Y_:J1)),T.auto=ye(J?!1:T.auto),T.clamp=ye(T.clamp||F1),T._min=T._max=null,T.valToPct=F(T)}}}L("x"),L("y"),s==1&&S.forEach(b=>{L(b.scale)}),M.forEach(b=>{L(b.scale)});for(let b in i.scales)L(b);let D=y[A],B=D.distr,G,N;D.ori==0?(xi(c,cT),G=r,N=o):(xi(c,hT),G=o,N=r);let W={};for(let b in y){let T=y[b];(T.min!=null||T.max!=null)&&(W[b]={min:T.min,max:T.max},T.min=T.max=null)}let q=i.tzDate||(b=>new Date(Tn(b/g))),V=i.fmtDate||kf,lt=g==1?c1(q):d1(q),Z=q0(q,$0(g==1?l1:u1,V)),j=Z0(q,Y0(p1,V)),et=[],dt=n.legend=yn({},_1,i.legend),ut=n.cursor=yn({},M1,{drag:{y:s==2}},i.cursor),tt=dt.show,mt=ut.show,yt=dt.markers;dt.idxs=et,yt.width=ye(yt.width),yt.dash=ye(yt.dash),yt.stroke=ye(yt.stroke),yt.fill=ye(yt.fill);let At,St,Xt,re=[],Gt=[],ue,le=!1,ie={};if(dt.live){let b=S[1]?S[1].values:null;le=b!=null,ue=le?b(n,1,0):{_:0};for(let T in ue)ie[T]=Lf}if(tt)if(At=zi("table",vT,c),Xt=zi("tbody",null,At),dt.mount(n,At),le){St=zi("thead",null,At,Xt);let b=zi("tr",null,St);zi("th",null,b);for(var Ke in ue)zi("th",M0,b).textContent=Ke}else xi(At,ST),dt.live&&xi(At,bT);let He={show:!0},un={show:!1};function Ne(b,T){if(T==0&&(le||!dt.live||s==2))return Lo;let I=[],U=zi("tr",MT,Xt,Xt.childNodes[T]);xi(U,b.class),b.show||xi(U,Er);let X=zi("th",null,U);if(yt.show){let ft=Ai(wT,X);if(T>0){let vt=yt.width(n,T);vt&&(ft.style.border=vt+"px "+yt.dash(n,T)+" "+yt.stroke(n,T)),ft.style.background=yt.fill(n,T)}}let J=Ai(M0,X);b.label instanceof HTMLElement?J.appendChild(b.label):J.textContent=b.label,T>0&&(yt.show||(J.style.color=b.width>0?yt.stroke(n,T):yt.fill(n,T)),xe("click",X,ft=>{if(ut._lock)return;jt(ft);let vt=S.indexOf(b);if((ft.ctrlKey||ft.metaKey)!=dt.isolate){let Nt=S.some((Ut,Ot)=>Ot>0&&Ot!=vt&&Ut.show);S.forEach((Ut,Ot)=>{Ot>0&&$i(Ot,Nt?Ot==vt?He:un:He,!0,gn.setSeries)})}else $i(vt,{show:!b.show},!0,gn.setSeries)},!1),Qt&&xe(A0,X,ft=>{ut._lock||(jt(ft),$i(S.indexOf(b),Br,!0,gn.setSeries))},!1));for(var at in ue){let ft=zi("td",ET,U);ft.textContent="--",I.push(ft)}return[U,I]}let Rn=new Map;function xe(b,T,I,U=!0){let X=Rn.get(T)||{},J=ut.bind[b](n,T,I,U);J&&(Tr(b,T,X[b]=J),Rn.set(T,X))}function xn(b,T,I){let U=Rn.get(T)||{};for(let X in U)(b==null||X==b)&&(wf(X,T,U[X]),delete U[X]);b==null&&Rn.delete(T)}let nn=0,dn=0,k=0,Ct=0,Kt=0,oe=0,Mt=Kt,Fe=oe,Ht=k,qt=Ct,P=0,w=0,$=0,ht=0;n.bbox={};let ot=!1,_t=!1,xt=!1,nt=!1,st=!1,pt=!1;function O(b,T,I){(I||b!=n.width||T!=n.height)&&rt(b,T),ce(!1),xt=!0,_t=!0,Gn()}function rt(b,T){n.width=nn=k=b,n.height=dn=Ct=T,Kt=oe=0,bt(),Wt();let I=n.bbox;P=I.left=Mr(Kt*Ee,.5),w=I.top=Mr(oe*Ee,.5),$=I.width=Mr(k*Ee,.5),ht=I.height=Mr(Ct*Ee,.5)}let it=3;function wt(){let b=!1,T=0;for(;!b;){T++;let I=Dr(T),U=Xi(T);b=T==it||I&&U,b||(rt(n.width,n.height),_t=!0)}}function gt({width:b,height:T}){O(b,T)}n.setSize=gt;function bt(){let b=!1,T=!1,I=!1,U=!1;M.forEach((X,J)=>{if(X.show&&X._show){let{side:at,_size:ft}=X,vt=at%2,Nt=X.label!=null?X.labelSize:0,Ut=ft+Nt;Ut>0&&(vt?(k-=Ut,at==3?(Kt+=Ut,U=!0):I=!0):(Ct-=Ut,at==0?(oe+=Ut,b=!0):T=!0))}}),Vi[0]=b,Vi[1]=I,Vi[2]=T,Vi[3]=U,k-=Ci[1]+Ci[3],Kt+=Ci[3],Ct-=Ci[2]+Ci[0],oe+=Ci[0]}function Wt(){let b=Kt+k,T=oe+Ct,I=Kt,U=oe;function X(J,at){switch(J){case 1:return b+=at,b-at;case 2:return T+=at,T-at;case 3:return I-=at,I+at;case 0:return U-=at,U+at}}M.forEach((J,at)=>{if(J.show&&J._show){let ft=J.side;J._pos=X(ft,J._size),J.label!=null&&(J._lpos=X(ft,J.labelSize))}})}if(ut.dataIdx==null){let b=ut.hover,T=b.skip=new Set(b.skip??[]);T.add(void 0);let I=b.prox=ye(b.prox),U=b.bias??=0;ut.dataIdx=(X,J,at,ft)=>{if(J==0)return at;let vt=at,Nt=I(X,J,at,ft)??Be,Ut=Nt>=0&&Nt<Be,Ot=D.ori==0?k:Ct,se=ut.left,Me=t[0],be=t[J];if(T.has(be[at])){vt=null;let me=null,Jt=null,$t;if(U==0||U==-1)for($t=at;me==null&&$t-- >0;)T.has(be[$t])||(me=$t);if(U==0||U==1)for($t=at;Jt==null&&$t++<be.length;)T.has(be[$t])||(Jt=$t);if(me!=null||Jt!=null)if(Ut){let qe=me==null?-1/0:G(Me[me],D,Ot,0),on=Jt==null?1/0:G(Me[Jt],D,Ot,0),Ln=se-qe,Ue=on-se;Ln<=Ue?Ln<=Nt&&(vt=me):Ue<=Nt&&(vt=Jt)}else vt=Jt==null?me:me==null?Jt:at-me<=Jt-at?me:Jt}else Ut&&An(se-G(Me[at],D,Ot,0))>Nt&&(vt=null);return vt}}let jt=b=>{ut.event=b};ut.idxs=et,ut._lock=!1;let ct=ut.points;ct.show=ye(ct.show),ct.size=ye(ct.size),ct.stroke=ye(ct.stroke),ct.width=ye(ct.width),ct.fill=ye(ct.fill);let kt=n.focus=yn({},i.focus||{alpha:.3},ut.focus),Qt=kt.prox>=0,Rt=Qt&&ct.one,ae=[],We=[],Yn=[];function Bo(b,T){let I=ct.show(n,T);if(I instanceof HTMLElement)return xi(I,xT),xi(I,b.class),ns(I,-10,-10,k,Ct),p.insertBefore(I,ae[T]),I}function Pr(b,T){if(s==1||T>0){let I=s==1&&y[b.scale].time,U=b.value;b.value=I?G0(U)?Z0(q,Y0(U,V)):U||j:U||D1,b.label=b.label||(I?E1:w1)}if(Rt||T>0){b.width=b.width==null?1:b.width,b.paths=b.paths||q1||OT,b.fillTo=ye(b.fillTo||k1),b.pxAlign=+Se(b.pxAlign,v),b.pxRound=s_(b.pxAlign),b.stroke=ye(b.stroke||null),b.fill=ye(b.fill||null),b._stroke=b._fill=b._paths=b._focus=null;let I=N1(ri(1,b.width),1),U=b.points=yn({},{size:I,width:ri(1,I*.2),stroke:b.stroke,space:I*2,paths:Y1,_stroke:null,_fill:null},b.points);U.show=ye(U.show),U.filter=ye(U.filter),U.fill=ye(U.fill),U.stroke=ye(U.stroke),U.paths=ye(U.paths),U.pxAlign=b.pxAlign}if(tt){let I=Ne(b,T);re.splice(T,0,I[0]),Gt.splice(T,0,I[1]),dt.values.push(null)}if(mt){et.splice(T,0,null);let I=null;Rt?T==0&&(I=Bo(b,T)):T>0&&(I=Bo(b,T)),ae.splice(T,0,I),We.splice(T,0,0),Yn.splice(T,0,0)}In("addSeries",T)}function hu(b,T){T=T??S.length,b=s==1?Pf(b,T,J0,n_):Pf(b,T,{},e_),S.splice(T,0,b),Pr(S[T],T)}n.addSeries=hu;function sl(b){if(S.splice(b,1),tt){dt.values.splice(b,1),Gt.splice(b,1);let T=re.splice(b,1)[0];xn(null,T.firstChild),T.remove()}mt&&(et.splice(b,1),ae.splice(b,1)[0].remove(),We.splice(b,1),Yn.splice(b,1)),In("delSeries",b)}n.delSeries=sl;let Vi=[!1,!1,!1,!1];function ss(b,T){if(b._show=b.show,b.show){let I=b.side%2,U=y[b.scale];U==null&&(b.scale=I?S[1].scale:A,U=y[b.scale]);let X=U.time;b.size=ye(b.size),b.space=ye(b.space),b.rotate=ye(b.rotate),nr(b.incrs)&&b.incrs.forEach(at=>{!ir.has(at)&&ir.set(at,__(at))}),b.incrs=ye(b.incrs||(U.distr==2?r1:X?g==1?a1:h1:wr)),b.splits=ye(b.splits||(X&&U.distr==1?lt:U.distr==3?Tf:U.distr==4?R1:A1)),b.stroke=ye(b.stroke),b.grid.stroke=ye(b.grid.stroke),b.ticks.stroke=ye(b.ticks.stroke),b.border.stroke=ye(b.border.stroke);let J=b.values;b.values=nr(J)&&!nr(J[0])?ye(J):X?nr(J)?q0(q,$0(J,V)):G0(J)?f1(q,J):J||Z:J||T1,b.filter=ye(b.filter||(U.distr>=3&&U.log==10?I1:U.distr==3&&U.log==2?L1:m_)),b.font=l_(b.font),b.labelFont=l_(b.labelFont),b._size=b.size(n,null,T,0),b._space=b._rotate=b._incrs=b._found=b._splits=b._values=null,b._size>0&&(Vi[T]=!0,b._el=Ai(mT,h))}}function rs(b,T,I,U){let[X,J,at,ft]=I,vt=T%2,Nt=0;return vt==0&&(ft||J)&&(Nt=T==0&&!X||T==2&&!at?Tn(K0.size/3):0),vt==1&&(X||at)&&(Nt=T==1&&!J||T==3&&!ft?Tn(Q0.size/2):0),Nt}let zo=n.padding=(i.padding||[rs,rs,rs,rs]).map(b=>ye(Se(b,rs))),Ci=n._padding=zo.map((b,T)=>b(n,T,Vi,0)),sn,cn=null,hn=null,Wi=s==1?S[0].idxs:null,hi=null,ws=!1;function Ho(b,T){if(t=b??[],n.data=n._data=t,s==2){sn=0;for(let I=1;I<S.length;I++)sn+=t[I][0].length}else{t.length==0&&(n.data=n._data=t=[[]]),hi=t[0],sn=hi.length;let I=t;if(B==2){I=t.slice();let U=I[0]=Array(sn);for(let X=0;X<sn;X++)U[X]=X}n._data=t=I}if(ce(!0),In("setData"),B==2&&(xt=!0),T!==!1){let I=D;I.auto(n,ws)?Go():As(A,I.min,I.max),nt=nt||ut.left>=0,pt=!0,Gn()}}n.setData=Ho;function Go(){ws=!0;let b,T;s==1&&(sn>0?(cn=Wi[0]=0,hn=Wi[1]=sn-1,b=t[0][cn],T=t[0][hn],B==2?(b=cn,T=hn):b==T&&(B==3?[b,T]=Oh(b,b,D.log,!1):B==4?[b,T]=Nf(b,b,D.log,!1):D.time?T=b+Tn(86400/g):[b,T]=Nh(b,T,Uf,!0))):(cn=Wi[0]=b=null,hn=Wi[1]=T=null)),As(A,b,T)}let Ir,Es,Lr,R,z,Q,Y,K,Et,Pt;function Tt(b,T,I,U,X,J){b??=E0,I??=Of,U??="butt",X??=E0,J??="round",b!=Ir&&(d.strokeStyle=Ir=b),X!=Es&&(d.fillStyle=Es=X),T!=Lr&&(d.lineWidth=Lr=T),J!=z&&(d.lineJoin=z=J),U!=Q&&(d.lineCap=Q=U),I!=R&&d.setLineDash(R=I)}function Lt(b,T,I,U){T!=Es&&(d.fillStyle=Es=T),b!=Y&&(d.font=Y=b),I!=K&&(d.textAlign=K=I),U!=Et&&(d.textBaseline=Et=U)}function zt(b,T,I,U,X=0){if(U.length>0&&b.auto(n,ws)&&(T==null||T.min==null)){let J=Se(cn,0),at=Se(hn,U.length-1),ft=I.min==null?IT(U,J,at,X,b.distr==3):[I.min,I.max];b.min=Gi(b.min,I.min=ft[0]),b.max=ri(b.max,I.max=ft[1])}}let ee={min:null,max:null};function de(){for(let U in y){let X=y[U];W[U]==null&&(X.min==null||W[A]!=null&&X.auto(n,ws))&&(W[U]=ee)}for(let U in y){let X=y[U];W[U]==null&&X.from!=null&&W[X.from]!=null&&(W[U]=ee)}W[A]!=null&&ce(!0);let b={};for(let U in W){let X=W[U];if(X!=null){let J=b[U]=Do(y[U],zT);if(X.min!=null)yn(J,X);else if(U!=A||s==2)if(sn==0&&J.from==null){let at=J.range(n,null,null,U);J.min=at[0],J.max=at[1]}else J.min=Be,J.max=-Be}}if(sn>0){S.forEach((U,X)=>{if(s==1){let J=U.scale,at=W[J];if(at==null)return;let ft=b[J];if(X==0){let vt=ft.range(n,ft.min,ft.max,J);ft.min=vt[0],ft.max=vt[1],cn=Hi(ft.min,t[0]),hn=Hi(ft.max,t[0]),hn-cn>1&&(t[0][cn]<ft.min&&cn++,t[0][hn]>ft.max&&hn--),U.min=hi[cn],U.max=hi[hn]}else U.show&&U.auto&&zt(ft,at,U,t[X],U.sorted);U.idxs[0]=cn,U.idxs[1]=hn}else if(X>0&&U.show&&U.auto){let[J,at]=U.facets,ft=J.scale,vt=at.scale,[Nt,Ut]=t[X],Ot=b[ft],se=b[vt];Ot!=null&&zt(Ot,W[ft],J,Nt,J.sorted),se!=null&&zt(se,W[vt],at,Ut,at.sorted),U.min=at.min,U.max=at.max}});for(let U in b){let X=b[U],J=W[U];if(X.from==null&&(J==null||J.min==null)){let at=X.range(n,X.min==Be?null:X.min,X.max==-Be?null:X.max,U);X.min=at[0],X.max=at[1]}}}for(let U in b){let X=b[U];if(X.from!=null){let J=b[X.from];if(J.min==null)X.min=X.max=null;else{let at=X.range(n,J.min,J.max,U);X.min=at[0],X.max=at[1]}}}let T={},I=!1;for(let U in b){let X=b[U],J=y[U];if(J.min!=X.min||J.max!=X.max){J.min=X.min,J.max=X.max;let at=J.distr;J._min=at==3?Ss(J.min):at==4?_f(J.min,J.asinh):at==100?J.fwd(J.min):J.min,J._max=at==3?Ss(J.max):at==4?_f(J.max,J.asinh):at==100?J.fwd(J.max):J.max,T[U]=I=!0}}if(I){S.forEach((U,X)=>{s==2?X>0&&T.y&&(U._paths=null):T[U.scale]&&(U._paths=null)});for(let U in T)xt=!0,In("setScale",U);mt&&ut.left>=0&&(nt=pt=!0)}for(let U in W)W[U]=null}function Bt(b){let T=Ef(cn-1,0,sn-1),I=Ef(hn+1,0,sn-1);for(;b[T]==null&&T>0;)T--;for(;b[I]==null&&I<sn-1;)I++;return[T,I]}function fe(){if(sn>0){let b=S.some(T=>T._focus)&&Pt!=kt.alpha;b&&(d.globalAlpha=Pt=kt.alpha),S.forEach((T,I)=>{if(I>0&&T.show&&(Qe(I,!1),Qe(I,!0),T._paths==null)){let U=Pt;Pt!=T.alpha&&(d.globalAlpha=Pt=T.alpha);let X=s==2?[0,t[I][0].length-1]:Bt(t[I]);T._paths=T.paths(n,I,X[0],X[1]),Pt!=U&&(d.globalAlpha=Pt=U)}}),S.forEach((T,I)=>{if(I>0&&T.show){let U=Pt;Pt!=T.alpha&&(d.globalAlpha=Pt=T.alpha),T._paths!=null&&Pe(I,!1);{let X=T._paths!=null?T._paths.gaps:null,J=T.points.show(n,I,cn,hn,X),at=T.points.filter(n,I,J,X);(J||at)&&(T.points._paths=T.points.paths(n,I,cn,hn,at),Pe(I,!0))}Pt!=U&&(d.globalAlpha=Pt=U),In("drawSeries",I)}}),b&&(d.globalAlpha=Pt=1)}}function Qe(b,T){let I=T?S[b].points:S[b];I._stroke=I.stroke(n,b),I._fill=I.fill(n,b)}function Pe(b,T){let I=T?S[b].points:S[b],{stroke:U,fill:X,clip:J,flags:at,_stroke:ft=I._stroke,_fill:vt=I._fill,_width:Nt=I.width}=I._paths;Nt=ze(Nt*Ee,3);let Ut=null,Ot=Nt%2/2;T&&vt==null&&(vt=Nt>0?"#fff":ft);let se=I.pxAlign==1&&Ot>0;if(se&&d.translate(Ot,Ot),!T){let Me=P-Nt/2,be=w-Nt/2,me=$+Nt,Jt=ht+Nt;Ut=new Path2D,Ut.rect(Me,be,me,Jt)}T?Ft(ft,Nt,I.dash,I.cap,vt,U,X,at,J):Ie(b,ft,Nt,I.dash,I.cap,vt,U,X,at,Ut,J),se&&d.translate(-Ot,-Ot)}function Ie(b,T,I,U,X,J,at,ft,vt,Nt,Ut){let Ot=!1;vt!=0&&C.forEach((se,Me)=>{if(se.series[0]==b){let be=S[se.series[1]],me=t[se.series[1]],Jt=(be._paths||ja).band;nr(Jt)&&(Jt=se.dir==1?Jt[0]:Jt[1]);let $t,qe=null;be.show&&Jt&&DT(me,cn,hn)?(qe=se.fill(n,Me)||J,$t=be._paths.clip):Jt=null,Ft(T,I,U,X,qe,at,ft,vt,Nt,Ut,$t,Jt),Ot=!0}}),Ot||Ft(T,I,U,X,J,at,ft,vt,Nt,Ut)}let vn=No|Rf;function Ft(b,T,I,U,X,J,at,ft,vt,Nt,Ut,Ot){Tt(b,T,I,U,X),(vt||Nt||Ot)&&(d.save(),vt&&d.clip(vt),Nt&&d.clip(Nt)),Ot?(ft&vn)==vn?(d.clip(Ot),Ut&&d.clip(Ut),ge(X,at),fn(b,J,T)):ft&Rf?(ge(X,at),d.clip(Ot),fn(b,J,T)):ft&No&&(d.save(),d.clip(Ot),Ut&&d.clip(Ut),ge(X,at),d.restore(),fn(b,J,T)):(ge(X,at),fn(b,J,T)),(vt||Nt||Ot)&&d.restore()}function fn(b,T,I){I>0&&(T instanceof Map?T.forEach((U,X)=>{d.strokeStyle=Ir=X,d.stroke(U)}):T!=null&&b&&d.stroke(T))}function ge(b,T){T instanceof Map?T.forEach((I,U)=>{d.fillStyle=Es=U,d.fill(I)}):T!=null&&b&&d.fill(T)}function os(b,T,I,U){let X=M[b],J;if(U<=0)J=[0,0];else{let at=X._space=X.space(n,b,T,I,U),ft=X._incrs=X.incrs(n,b,T,I,U,at);J=tA(T,I,ft,U,at)}return X._found=J}function pn(b,T,I,U,X,J,at,ft,vt,Nt){let Ut=at%2/2;v==1&&d.translate(Ut,Ut),Tt(ft,at,vt,Nt,ft),d.beginPath();let Ot,se,Me,be,me=X+(U==0||U==3?-J:J);I==0?(se=X,be=me):(Ot=X,Me=me);for(let Jt=0;Jt<b.length;Jt++)T[Jt]!=null&&(I==0?Ot=Me=b[Jt]:se=be=b[Jt],d.moveTo(Ot,se),d.lineTo(Me,be));d.stroke(),v==1&&d.translate(-Ut,-Ut)}function Dr(b){let T=!0;return M.forEach((I,U)=>{if(!I.show)return;let X=y[I.scale];if(X.min==null){I._show&&(T=!1,I._show=!1,ce(!1));return}else I._show||(T=!1,I._show=!0,ce(!1));let J=I.side,at=J%2,{min:ft,max:vt}=X,[Nt,Ut]=os(U,ft,vt,at==0?k:Ct);if(Ut==0)return;let Ot=X.distr==2,se=I._splits=I.splits(n,U,ft,vt,Nt,Ut,Ot),Me=X.distr==2?se.map($t=>hi[$t]):se,be=X.distr==2?hi[se[1]]-hi[se[0]]:Nt,me=I._values=I.values(n,I.filter(n,Me,U,Ut,be),U,Ut,be);I._rotate=J==2?I.rotate(n,me,U,Ut):0;let Jt=I._size;I._size=Ri(I.size(n,me,U,b)),Jt!=null&&I._size!=Jt&&(T=!1)}),T}function Xi(b){let T=!0;return zo.forEach((I,U)=>{let X=I(n,U,Vi,b);X!=Ci[U]&&(T=!1),Ci[U]=X}),T}function as(){for(let b=0;b<M.length;b++){let T=M[b];if(!T.show||!T._show)continue;let I=T.side,U=I%2,X,J,at=T.stroke(n,b),ft=I==0||I==3?-1:1,[vt,Nt]=T._found;if(T.label!=null){let Jn=T.labelGap*ft,fi=Tn((T._lpos+Jn)*Ee);Lt(T.labelFont[0],at,"center",I==2?"top":w0),d.save(),U==1?(X=J=0,d.translate(fi,Tn(w+ht/2)),d.rotate((I==3?-Lh:Lh)/2)):(X=Tn(P+$/2),J=fi);let or=f_(T.label)?T.label(n,b,vt,Nt):T.label;d.fillText(or,X,J),d.restore()}if(Nt==0)continue;let Ut=y[T.scale],Ot=U==0?$:ht,se=U==0?P:w,Me=T._splits,be=Ut.distr==2?Me.map(Jn=>hi[Jn]):Me,me=Ut.distr==2?hi[Me[1]]-hi[Me[0]]:vt,Jt=T.ticks,$t=T.border,qe=Jt.show?Jt.size:0,on=Tn(qe*Ee),Ln=Tn((T.alignTo==2?T._size-qe-T.gap:T.gap)*Ee),Ue=T._rotate*-Lh/180,an=m(T._pos*Ee),ui=(on+Ln)*ft,Kn=an+ui;J=U==0?Kn:0,X=U==1?Kn:0;let Si=T.font[0],Pi=T.align==1?Ro:T.align==2?pf:Ue>0?Ro:Ue<0?pf:U==0?"center":I==3?pf:Ro,Yi=Ue||U==1?"middle":I==2?"top":w0;Lt(Si,at,Pi,Yi);let di=T.font[1]*T.lineGap,Mi=Me.map(Jn=>m(a(Jn,Ut,Ot,se))),Ii=T._values;for(let Jn=0;Jn<Ii.length;Jn++){let fi=Ii[Jn];if(fi!=null){U==0?X=Mi[Jn]:J=Mi[Jn],fi=""+fi;let or=fi.indexOf(`
`)==-1?[fi]:fi.split(/\n/gm);for(let jn=0;jn<or.length;jn++){let _p=or[jn];Ue?(d.save(),d.translate(X,J+jn*di),d.rotate(Ue),d.fillText(_p,0,0),d.restore()):d.fillText(_p,X,J+jn*di)}}}Jt.show&&pn(Mi,Jt.filter(n,be,b,Nt,me),U,I,an,on,ze(Jt.width*Ee,3),Jt.stroke(n,b),Jt.dash,Jt.cap);let Zi=T.grid;Zi.show&&pn(Mi,Zi.filter(n,be,b,Nt,me),U,U==0?2:1,U==0?w:P,U==0?ht:$,ze(Zi.width*Ee,3),Zi.stroke(n,b),Zi.dash,Zi.cap),$t.show&&pn([an],[1],U==0?1:0,U==0?1:2,U==1?w:P,U==1?ht:$,ze($t.width*Ee,3),$t.stroke(n,b),$t.dash,$t.cap)}In("drawAxes")}function ce(b){S.forEach((T,I)=>{I>0&&(T._paths=null,b&&(s==1?(T.min=null,T.max=null):T.facets.forEach(U=>{U.min=null,U.max=null})))})}let rn=!1,Zn=!1,Le=[];function mn(){Zn=!1;for(let b=0;b<Le.length;b++)In(...Le[b]);Le.length=0}function Gn(){rn||(qT(Qf),rn=!0)}function rl(b,T=!1){rn=!0,Zn=T,b(n),Qf(),T&&Le.length>0&&queueMicrotask(mn)}n.batch=rl;function Qf(){if(ot&&(de(),ot=!1),xt&&(wt(),xt=!1),_t){if(Ze(f,Ro,Kt),Ze(f,"top",oe),Ze(f,Ya,k),Ze(f,Za,Ct),Ze(p,Ro,Kt),Ze(p,"top",oe),Ze(p,Ya,k),Ze(p,Za,Ct),Ze(h,Ya,nn),Ze(h,Za,dn),u.width=Tn(nn*Ee),u.height=Tn(dn*Ee),M.forEach(({_el:b,_show:T,_size:I,_pos:U,side:X})=>{if(b!=null)if(T){let J=X===3||X===0?I:0,at=X%2==1;Ze(b,at?"left":"top",U-J),Ze(b,at?"width":"height",I),Ze(b,at?"top":"left",at?oe:Kt),Ze(b,at?"height":"width",at?Ct:k),Mf(b,Er)}else xi(b,Er)}),Ir=Es=Lr=z=Q=Y=K=Et=R=null,Pt=1,Xo(!0),Kt!=Mt||oe!=Fe||k!=Ht||Ct!=qt){ce(!1);let b=k/Ht,T=Ct/qt;if(mt&&!nt&&ut.left>=0){ut.left*=b,ut.top*=T,Nr&&ns(Nr,Tn(ut.left),0,k,Ct),Ur&&ns(Ur,0,Tn(ut.top),k,Ct);for(let I=0;I<ae.length;I++){let U=ae[I];U!=null&&(We[I]*=b,Yn[I]*=T,ns(U,Ri(We[I]),Ri(Yn[I]),k,Ct))}}if($e.show&&!st&&$e.left>=0&&$e.width>0){$e.left*=b,$e.width*=b,$e.top*=T,$e.height*=T;for(let I in gu)Ze(kr,I,$e[I])}Mt=Kt,Fe=oe,Ht=k,qt=Ct}In("setSize"),_t=!1}nn>0&&dn>0&&(d.clearRect(0,0,u.width,u.height),In("drawClear"),E.forEach(b=>b()),In("draw")),$e.show&&st&&(ol($e),st=!1),mt&&nt&&(rr(null,!0,!1),nt=!1),dt.show&&dt.live&&pt&&(pu(),pt=!1),l||(l=!0,n.status=1,In("ready")),ws=!1,rn=!1}n.redraw=(b,T)=>{xt=T||!1,b!==!1?As(A,D.min,D.max):Gn()};function uu(b,T){let I=y[b];if(I.from==null){if(sn==0){let U=I.range(n,T.min,T.max,b);T.min=U[0],T.max=U[1]}if(T.min>T.max){let U=T.min;T.min=T.max,T.max=U}if(sn>1&&T.min!=null&&T.max!=null&&T.max-T.min<1e-16)return;b==A&&I.distr==2&&sn>0&&(T.min=Hi(T.min,t[0]),T.max=Hi(T.max,t[0]),T.min==T.max&&T.max++),W[b]=T,ot=!0,Gn()}}n.setScale=uu;let du,fu,Nr,Ur,tp,ep,Fr,Or,np,ip,Xe,Je,Ts=!1,Bn=ut.drag,Cn=Bn.x,Pn=Bn.y;mt&&(ut.x&&(du=Ai(_T,p)),ut.y&&(fu=Ai(yT,p)),D.ori==0?(Nr=du,Ur=fu):(Nr=fu,Ur=du),Xe=ut.left,Je=ut.top);let $e=n.select=yn({show:!0,over:!0,left:0,width:0,top:0,height:0},i.select),kr=$e.show?Ai(gT,$e.over?p:f):null;function ol(b,T){if($e.show){for(let I in b)$e[I]=b[I],I in gu&&Ze(kr,I,b[I]);T!==!1&&In("setSelect")}}n.setSelect=ol;function Ay(b){if(S[b].show)tt&&Mf(re[b],Er);else if(tt&&xi(re[b],Er),mt){let I=Rt?ae[0]:ae[b];I!=null&&ns(I,-10,-10,k,Ct)}}function As(b,T,I){uu(b,{min:T,max:I})}function $i(b,T,I,U){T.focus!=null&&Ly(b),T.show!=null&&S.forEach((X,J)=>{J>0&&(b==J||b==null)&&(X.show=T.show,Ay(J),s==2?(As(X.facets[0].scale,null,null),As(X.facets[1].scale,null,null)):As(X.scale,null,null),Gn())}),I!==!1&&In("setSeries",b,T),U&&$o("setSeries",n,b,T)}n.setSeries=$i;function Ry(b,T){yn(C[b],T)}function Cy(b,T){b.fill=ye(b.fill||null),b.dir=Se(b.dir,-1),T=T??C.length,C.splice(T,0,b)}function Py(b){b==null?C.length=0:C.splice(b,1)}n.addBand=Cy,n.setBand=Ry,n.delBand=Py;function Iy(b,T){S[b].alpha=T,mt&&ae[b]!=null&&(ae[b].style.opacity=T),tt&&re[b]&&(re[b].style.opacity=T)}let ls,Rs,sr,Br={focus:!0};function Ly(b){if(b!=sr){let T=b==null,I=kt.alpha!=1;S.forEach((U,X)=>{if(s==1||X>0){let J=T||X==0||X==b;U._focus=T?null:J,I&&Iy(X,J?1:kt.alpha)}}),sr=b,I&&Gn()}}tt&&Qt&&xe(R0,At,b=>{ut._lock||(jt(b),sr!=null&&$i(null,Br,!0,gn.setSeries))});function qi(b,T,I){let U=y[T];I&&(b=b/Ee-(U.ori==1?oe:Kt));let X=k;U.ori==1&&(X=Ct,b=X-b),U.dir==-1&&(b=X-b);let J=U._min,at=U._max,ft=b/X,vt=J+(at-J)*ft,Nt=U.distr;return Nt==3?Io(10,vt):Nt==4?UT(vt,U.asinh):Nt==100?U.bwd(vt):vt}function Dy(b,T){let I=qi(b,A,T);return Hi(I,t[0],cn,hn)}n.valToIdx=b=>Hi(b,t[0]),n.posToIdx=Dy,n.posToVal=qi,n.valToPos=(b,T,I)=>y[T].ori==0?r(b,y[T],I?$:k,I?P:0):o(b,y[T],I?ht:Ct,I?w:0),n.setCursor=(b,T,I)=>{Xe=b.left,Je=b.top,rr(null,T,I)};function sp(b,T){Ze(kr,Ro,$e.left=b),Ze(kr,Ya,$e.width=T)}function rp(b,T){Ze(kr,"top",$e.top=b),Ze(kr,Za,$e.height=T)}let Vo=D.ori==0?sp:rp,Wo=D.ori==1?sp:rp;function Ny(){if(tt&&dt.live)for(let b=s==2?1:0;b<S.length;b++){if(b==0&&le)continue;let T=dt.values[b],I=0;for(let U in T)Gt[b][I++].firstChild.nodeValue=T[U]}}function pu(b,T){if(b!=null&&(b.idxs?b.idxs.forEach((I,U)=>{et[U]=I}):BT(b.idx)||et.fill(b.idx),dt.idx=et[0]),tt&&dt.live){for(let I=0;I<S.length;I++)(I>0||s==1&&!le)&&Uy(I,et[I]);Ny()}pt=!1,T!==!1&&In("setLegend")}n.setLegend=pu;function Uy(b,T){let I=S[b],U=b==0&&B==2?hi:t[b],X;le?X=I.values(n,b,T)??ie:(X=I.value(n,T==null?null:U[T],b,T),X=X==null?ie:{_:X}),dt.values[b]=X}function rr(b,T,I){np=Xe,ip=Je,[Xe,Je]=ut.move(n,Xe,Je),ut.left=Xe,ut.top=Je,mt&&(Nr&&ns(Nr,Tn(Xe),0,k,Ct),Ur&&ns(Ur,0,Tn(Je),k,Ct));let U,X=cn>hn;ls=Be,Rs=null;let J=D.ori==0?k:Ct,at=D.ori==1?k:Ct;if(Xe<0||sn==0||X){U=ut.idx=null;for(let ft=0;ft<S.length;ft++){let vt=ae[ft];vt!=null&&ns(vt,-10,-10,k,Ct)}Qt&&$i(null,Br,!0,b==null&&gn.setSeries),dt.live&&(et.fill(U),pt=!0)}else{let ft,vt,Nt;s==1&&(ft=D.ori==0?Xe:Je,vt=qi(ft,A),U=ut.idx=Hi(vt,t[0],cn,hn),Nt=G(t[0][U],D,J,0));let Ut=-10,Ot=-10,se=0,Me=0,be=!0,me="",Jt="";for(let $t=s==2?1:0;$t<S.length;$t++){let qe=S[$t],on=et[$t],Ln=on==null?null:s==1?t[$t][on]:t[$t][1][on],Ue=ut.dataIdx(n,$t,U,vt),an=Ue==null?null:s==1?t[$t][Ue]:t[$t][1][Ue];if(pt=pt||an!=Ln||Ue!=on,et[$t]=Ue,$t>0&&qe.show){let ui=Ue==null?-10:Ue==U?Nt:G(s==1?t[0][Ue]:t[$t][0][Ue],D,J,0),Kn=an==null?-10:N(an,s==1?y[qe.scale]:y[qe.facets[1].scale],at,0);if(Qt&&an!=null){let Si=D.ori==1?Xe:Je,Pi=An(kt.dist(n,$t,Ue,Kn,Si));if(Pi<ls){let Yi=kt.bias;if(Yi!=0){let di=qi(Si,qe.scale),Mi=an>=0?1:-1,Ii=di>=0?1:-1;Ii==Mi&&(Ii==1?Yi==1?an>=di:an<=di:Yi==1?an<=di:an>=di)&&(ls=Pi,Rs=$t)}else ls=Pi,Rs=$t}}if(pt||Rt){let Si,Pi;D.ori==0?(Si=ui,Pi=Kn):(Si=Kn,Pi=ui);let Yi,di,Mi,Ii,Zi,Jn,fi=!0,or=ct.bbox;if(or!=null){fi=!1;let jn=or(n,$t);Mi=jn.left,Ii=jn.top,Yi=jn.width,di=jn.height}else Mi=Si,Ii=Pi,Yi=di=ct.size(n,$t);if(Jn=ct.fill(n,$t),Zi=ct.stroke(n,$t),Rt)$t==Rs&&ls<=kt.prox&&(Ut=Mi,Ot=Ii,se=Yi,Me=di,be=fi,me=Jn,Jt=Zi);else{let jn=ae[$t];jn!=null&&(We[$t]=Mi,Yn[$t]=Ii,U0(jn,Yi,di,fi),D0(jn,Jn,Zi),ns(jn,Ri(Mi),Ri(Ii),k,Ct))}}}}if(Rt){let $t=kt.prox,qe=sr==null?ls<=$t:ls>$t||Rs!=sr;if(pt||qe){let on=ae[0];on!=null&&(We[0]=Ut,Yn[0]=Ot,U0(on,se,Me,be),D0(on,me,Jt),ns(on,Ri(Ut),Ri(Ot),k,Ct))}}}if($e.show&&Ts)if(b!=null){let[ft,vt]=gn.scales,[Nt,Ut]=gn.match,[Ot,se]=b.cursor.sync.scales,Me=b.cursor.drag;if(Cn=Me._x,Pn=Me._y,Cn||Pn){let{left:be,top:me,width:Jt,height:$t}=b.select,qe=b.scales[Ot].ori,on=b.posToVal,Ln,Ue,an,ui,Kn,Si=ft!=null&&Nt(ft,Ot),Pi=vt!=null&&Ut(vt,se);Si&&Cn?(qe==0?(Ln=be,Ue=Jt):(Ln=me,Ue=$t),an=y[ft],ui=G(on(Ln,Ot),an,J,0),Kn=G(on(Ln+Ue,Ot),an,J,0),Vo(Gi(ui,Kn),An(Kn-ui))):Vo(0,J),Pi&&Pn?(qe==1?(Ln=be,Ue=Jt):(Ln=me,Ue=$t),an=y[vt],ui=N(on(Ln,se),an,at,0),Kn=N(on(Ln+Ue,se),an,at,0),Wo(Gi(ui,Kn),An(Kn-ui))):Wo(0,at)}else _u()}else{let ft=An(np-tp),vt=An(ip-ep);if(D.ori==1){let se=ft;ft=vt,vt=se}Cn=Bn.x&&ft>=Bn.dist,Pn=Bn.y&&vt>=Bn.dist;let Nt=Bn.uni;Nt!=null?Cn&&Pn&&(Cn=ft>=Nt,Pn=vt>=Nt,!Cn&&!Pn&&(vt>ft?Pn=!0:Cn=!0)):Bn.x&&Bn.y&&(Cn||Pn)&&(Cn=Pn=!0);let Ut,Ot;Cn&&(D.ori==0?(Ut=Fr,Ot=Xe):(Ut=Or,Ot=Je),Vo(Gi(Ut,Ot),An(Ot-Ut)),Pn||Wo(0,at)),Pn&&(D.ori==1?(Ut=Fr,Ot=Xe):(Ut=Or,Ot=Je),Wo(Gi(Ut,Ot),An(Ot-Ut)),Cn||Vo(0,J)),!Cn&&!Pn&&(Vo(0,0),Wo(0,0))}if(Bn._x=Cn,Bn._y=Pn,b==null){if(I){if(gp!=null){let[ft,vt]=gn.scales;gn.values[0]=ft!=null?qi(D.ori==0?Xe:Je,ft):null,gn.values[1]=vt!=null?qi(D.ori==1?Xe:Je,vt):null}$o(mf,n,Xe,Je,k,Ct,U)}if(Qt){let ft=I&&gn.setSeries,vt=kt.prox;sr==null?ls<=vt&&$i(Rs,Br,!0,ft):ls>vt?$i(null,Br,!0,ft):Rs!=sr&&$i(Rs,Br,!0,ft)}}pt&&(dt.idx=U,pu()),T!==!1&&In("setCursor")}let Cs=null;Object.defineProperty(n,"rect",{get(){return Cs==null&&Xo(!1),Cs}});function Xo(b=!1){b?Cs=null:(Cs=p.getBoundingClientRect(),In("syncRect",Cs))}function op(b,T,I,U,X,J,at){ut._lock||Ts&&b!=null&&b.movementX==0&&b.movementY==0||(mu(b,T,I,U,X,J,at,!1,b!=null),b!=null?rr(null,!0,!0):rr(T,!0,!1))}function mu(b,T,I,U,X,J,at,ft,vt){if(Cs==null&&Xo(!1),jt(b),b!=null)I=b.clientX-Cs.left,U=b.clientY-Cs.top;else{if(I<0||U<0){Xe=-10,Je=-10;return}let[Nt,Ut]=gn.scales,Ot=T.cursor.sync,[se,Me]=Ot.values,[be,me]=Ot.scales,[Jt,$t]=gn.match,qe=T.axes[0].side%2==1,on=D.ori==0?k:Ct,Ln=D.ori==1?k:Ct,Ue=qe?J:X,an=qe?X:J,ui=qe?U:I,Kn=qe?I:U;if(be!=null?I=Jt(Nt,be)?a(se,y[Nt],on,0):-10:I=on*(ui/Ue),me!=null?U=$t(Ut,me)?a(Me,y[Ut],Ln,0):-10:U=Ln*(Kn/an),D.ori==1){let Si=I;I=U,U=Si}}vt&&(T==null||T.cursor.event.type==mf)&&((I<=1||I>=k-1)&&(I=Mr(I,k)),(U<=1||U>=Ct-1)&&(U=Mr(U,Ct))),ft?(tp=I,ep=U,[Fr,Or]=ut.move(n,I,U)):(Xe=I,Je=U)}let gu={width:0,height:0,left:0,top:0};function _u(){ol(gu,!1)}let ap,lp,cp,hp;function up(b,T,I,U,X,J,at){Ts=!0,Cn=Pn=Bn._x=Bn._y=!1,mu(b,T,I,U,X,J,at,!0,!1),b!=null&&(xe(gf,bf,dp,!1),$o(T0,n,Fr,Or,k,Ct,null));let{left:ft,top:vt,width:Nt,height:Ut}=$e;ap=ft,lp=vt,cp=Nt,hp=Ut}function dp(b,T,I,U,X,J,at){Ts=Bn._x=Bn._y=!1,mu(b,T,I,U,X,J,at,!1,!0);let{left:ft,top:vt,width:Nt,height:Ut}=$e,Ot=Nt>0||Ut>0,se=ap!=ft||lp!=vt||cp!=Nt||hp!=Ut;if(Ot&&se&&ol($e),Bn.setScale&&Ot&&se){let Me=ft,be=Nt,me=vt,Jt=Ut;if(D.ori==1&&(Me=vt,be=Ut,me=ft,Jt=Nt),Cn&&As(A,qi(Me,A),qi(Me+be,A)),Pn)for(let $t in y){let qe=y[$t];$t!=A&&qe.from==null&&qe.min!=Be&&As($t,qi(me+Jt,$t),qi(me,$t))}_u()}else ut.lock&&(ut._lock=!ut._lock,rr(T,!0,b!=null));b!=null&&(xn(gf,bf),$o(gf,n,Xe,Je,k,Ct,null))}function Fy(b,T,I,U,X,J,at){if(ut._lock)return;jt(b);let ft=Ts;if(Ts){let vt=!0,Nt=!0,Ut=10,Ot,se;D.ori==0?(Ot=Cn,se=Pn):(Ot=Pn,se=Cn),Ot&&se&&(vt=Xe<=Ut||Xe>=k-Ut,Nt=Je<=Ut||Je>=Ct-Ut),Ot&&vt&&(Xe=Xe<Fr?0:k),se&&Nt&&(Je=Je<Or?0:Ct),rr(null,!0,!0),Ts=!1}Xe=-10,Je=-10,et.fill(null),rr(null,!0,!0),ft&&(Ts=ft)}function fp(b,T,I,U,X,J,at){ut._lock||(jt(b),Go(),_u(),b!=null&&$o(C0,n,Xe,Je,k,Ct,null))}function pp(){M.forEach(eA),O(n.width,n.height,!0)}Tr(Dh,Po,pp);let zr={};zr.mousedown=up,zr.mousemove=op,zr.mouseup=dp,zr.dblclick=fp,zr.setSeries=(b,T,I,U)=>{let X=gn.match[2];I=X(n,T,I),I!=-1&&$i(I,U,!0,!1)},mt&&(xe(T0,p,up),xe(mf,p,op),xe(A0,p,b=>{jt(b),Xo(!1)}),xe(R0,p,Fy),xe(C0,p,fp),Cf.add(n),n.syncRect=Xo);let al=n.hooks=i.hooks||{};function In(b,T,I){Zn?Le.push([b,T,I]):b in al&&al[b].forEach(U=>{U.call(null,n,T,I)})}(i.plugins||[]).forEach(b=>{for(let T in b.hooks)al[T]=(al[T]||[]).concat(b.hooks[T])});let mp=(b,T,I)=>I,gn=yn({key:null,setSeries:!1,filters:{pub:z0,sub:z0},scales:[A,S[1]?S[1].scale:null],match:[H0,H0,mp],values:[null,null]},ut.sync);gn.match.length==2&&gn.match.push(mp),ut.sync=gn;let gp=gn.key,yu=O_(gp);function $o(b,T,I,U,X,J,at){gn.filters.pub(b,T,I,U,X,J,at)&&yu.pub(b,T,I,U,X,J,at)}yu.sub(n);function Oy(b,T,I,U,X,J,at){gn.filters.sub(b,T,I,U,X,J,at)&&zr[b](null,T,I,U,X,J,at)}n.pub=Oy;function ky(){yu.unsub(n),Cf.delete(n),Rn.clear(),wf(Dh,Po,pp),c.remove(),At?.remove(),In("destroy")}n.destroy=ky;function xu(){In("init",i,t),Ho(t||i.data,!1),W[A]?uu(A,W[A]):Go(),st=$e.show&&($e.width>0||$e.height>0),nt=pt=!0,O(i.width,i.height)}return S.forEach(Pr),M.forEach(ss),e?e instanceof HTMLElement?(e.appendChild(c),xu()):e(n,xu):xu(),n}Hn.assign=yn;Hn.fmtNum=Ff;Hn.rangeNum=Nh;Hn.rangeLog=Oh;Hn.rangeAsinh=Nf;Hn.orient=Rr;Hn.pxRatio=Ee;Hn.join=$T;Hn.fmtDate=kf,Hn.tzDate=i1;Hn.sync=O_;{Hn.addGap=B1,Hn.clipGaps=zh;let i=Hn.paths={points:V_};i.linear=X_,i.stepped=G1,i.bars=V1,i.spline=X1}function ko({label:i,unit:t}){return t?`${i} [${t}]`:i}function Z_(i){return Array.from(i,t=>Number.isFinite(t)?t:null)}function K_(i,t,e,[n,...s]){let r=n.length-1;if(r<0)return`${i}: no data yet`;let o=e.map((a,l)=>{let c=s[l]?.findLast(u=>Number.isFinite(u));return`${ko(a)} ${c===void 0?"without value":Number(c.toPrecision(4))}`});return`${i}, ${ko(t)} ${Number(n[0].toPrecision(4))} to ${Number(n[r].toPrecision(4))}: ${o.join(", ")}`}var nA=170;function kn(i){return i?.startsWith("--")?getComputedStyle(document.documentElement).getPropertyValue(i).trim():i}function Wh(i,{title:t,x:e,series:n,height:s=nA,points:r=!1,legend:o=!0}){let a=_("div",{role:"img","aria-label":`${t}: no data yet`,class:"plot-canvas"}),l=_("figure",{class:"plot"},_("figcaption",{},t),a);i.append(l);let c=[[],...n.map(()=>[])],u=null,d=null,h=()=>Math.max(160,a.clientWidth);function f(g){if(d===null)return;let S=g.valToPos(d,"x",!0),{left:M,top:y,width:C,height:A}=g.bbox;S<M||S>M+C||(g.ctx.save(),g.ctx.strokeStyle=kn("--faint"),g.ctx.lineWidth=devicePixelRatio,g.ctx.beginPath(),g.ctx.moveTo(S,y),g.ctx.lineTo(S,y+A),g.ctx.stroke(),g.ctx.restore())}function p(){u?.destroy();let g=M=>({label:M,labelSize:18,labelFont:"11px system-ui, sans-serif",font:"11px system-ui, sans-serif",stroke:kn("--ink"),grid:{stroke:kn("--line"),width:.5},ticks:{stroke:kn("--line"),width:.5},size:54}),S=[...new Set(n.map(M=>M.unit??""))].filter(Boolean);u=new Hn({width:h(),height:s,scales:{x:{time:!1}},axes:[{...g(ko(e)),size:30},g(S.length===1?`[${S[0]}]`:"")],series:[{label:ko(e)},...n.map(M=>({label:ko(M),stroke:kn(M.colour),dash:M.dash??[],width:1.6,spanGaps:!1,points:r?{show:!0,size:5}:void 0}))],legend:{show:o},cursor:{drag:{x:!0,y:!1}},hooks:{draw:[f]}},c,a)}let v=()=>p();document.addEventListener("theme",v);let m=new ResizeObserver(()=>{u&&a.clientWidth&&u.width!==h()&&u.setSize({width:h(),height:s})});return m.observe(a),p(),{set(g){c=g.map(Z_),u.setData(c),a.setAttribute("aria-label",K_(t,e,n,g))},mark(g){g!==d&&(d=g,u.redraw(!1,!1))},destroy(){document.removeEventListener("theme",v),m.disconnect(),u.destroy(),l.remove()}}}var J_=[[],[9,5],[2,4],[9,4,2,4],[16,5]],iA=[1,3];function Cr(i,t="clean"){let e=t==="degraded"?iA:J_[(i+Math.floor(i/6))%J_.length];return{name:`--data-${i%6+1}`,dash:e}}function Xf(i){return kn(Cr(i).name)}var j_=[{variable:"ade",person:null},{variable:"time",person:null}],sA=400;function Q_(i){let t=_("div",{}),e=j_.map(h=>({...h})),n={key:"",plot:null},s=null;async function r(){if(s=null,!i.recording)return;for(let f of[...e])await o(f);let h=await i.call("results");h&&(l(h.horizon),i.emit("results",h))}async function o(h){if(!(await i.call("variables"))?.some(g=>g.name===h.variable))return;let p=await i.call("series",{variable:h.variable,person:h.person});if(!p||!e.includes(h))return;let v=p.rows.filter(g=>g.values.some(S=>S!==null)),m=h.person===null?p.label:`${p.label} of person ${h.person}`;a(h,m,{label:"Frame"},v,p.unit,p.frames),h.plot?.mark(p.frames[i.index])}function a(h,f,p,v,m,g,S=!1){let M=JSON.stringify([f,m,v.map(y=>[y.slot,y.input,y.label])]);if(M!==h.key){h.plot?.destroy(),h.box?.remove(),h.key=M,h.box=_("div",{class:"plot-box"}),h.variable&&!j_.some(C=>C.variable===h.variable&&h.person===null)&&h.box.append(_("button",{type:"button",class:"close","aria-label":`Remove plot ${f}`,onclick:()=>c(h)},"\xD7")),t.insertBefore(h.box,h===n?null:n.box??null);let y=v.map(C=>{let{name:A,dash:x}=Cr(C.slot,C.input);return{label:C.label+(C.input==="degraded"?" (degraded)":""),unit:m,colour:A,dash:x}});h.plot=Wh(h.box,{title:f,x:p,series:y,points:S,legend:!1,height:150})}h.plot.set([g,...v.map(y=>y.values)])}function l({seconds:h,rows:f,unit:p}){a(n,"Error by horizon",{label:"Time ahead",unit:"s"},f,p,h,!0)}function c(h){e.splice(e.indexOf(h),1),h.plot?.destroy(),h.box?.remove()}let u=()=>{s??=setTimeout(r,sA)};i.on("board lines ended",u),i.on("index",()=>{for(let h of e)h.plot?.mark(i.recording?.frames[i.index]??null)}),i.on("plot",h=>{e.push({...h}),u()});let d=_("button",{type:"button",onclick:()=>rA(i)},"Add plot\u2026");return _("section",{"aria-label":"Plots"},_("div",{class:"heading"},_("h2",{},"Plots"),d),t)}async function rA(i){let t=await i.call("variables");if(!t)return;let e=On([{name:"variable",label:"Variable",kind:"choice",value:"cost",choices:t.map(n=>[n.name,n.unit?`${n.label} [${n.unit}]`:n.label])},{name:"person",label:"Person",kind:"whole",value:i.person,low:0,note:"empty: everybody; parameters are then medians over people"}]);De("Add plot",e.element,[["Cancel",()=>!0],["Add",()=>(i.emit("plot",e.values()),!0)]])}var ty=["","none"];function ey(i){let{models:t,costs:e,searches:n,goals:s,crowd:r}=i.tables,o=v=>v.map(m=>[m.name,m.name]),a=On([{name:"model",label:"Simulation model",kind:"choice",value:"orca",choices:o(t)},{name:"cost",label:"Cost function",kind:"choice",value:"progressive",choices:[ty,...o(e)]},{name:"search",label:"Search (calibrator)",kind:"choice",value:"genetic",choices:[ty,...o(n)],note:"without cost and search, the parameters below are used"},{name:"goal",label:"Goals of the people",kind:"choice",value:"",choices:[["","current-direction"],...o(s).filter(([v])=>v!=="current-direction")]},{name:"budget",label:"Budget: candidate crowds per frame",kind:"whole",value:500,low:1,high:1e5},{name:"tolerance",label:"Stop at a cost of",unit:"m",kind:"number",low:0,note:"empty: never"},{name:"patience",label:"Stop after evaluations without improvement",kind:"whole",low:1,note:"empty: never"},{name:"samples",label:"Futures per person",kind:"whole",value:1,low:1,high:100,note:"more than one only for goals with several destinations"},{name:"learnt",label:"From the learning part of the recording",kind:"choice",value:"",choices:[["","nothing"],["prior","a prior of the parameters"],["shared","one set of parameters for everybody"]]}],()=>f()),l=_("p",{class:"hint"}),c=_("fieldset",{}),u=null,d=[],h=null;function f(){let{model:v,cost:m,search:g,goal:S}=a.values(),M=t.find(A=>A.name===v),y=[M,tl(e,m),tl(n,g),tl(s,S||"current-direction")];if(It(l,y.filter(Boolean).map(A=>_("span",{class:"about"},`${A.name}: ${A.about}`))),h===v)return;h=v;let C=[...M.parameters,...r.filter(A=>!M.parameters.some(x=>x.name===A.name))];u=On(C),d=M.free.map(A=>_("input",{type:"checkbox",value:A})),It(c,_("legend",{},`Parameters of ${v}`),u.element,_("p",{},"Calibrated parameters (none chosen: all)"),_("div",{class:"checks"},d.map(A=>_("label",{},A,A.value.replaceAll("_"," ")))))}f();let p=async()=>{let{goal:v,...m}=a.values(),g=d.filter(M=>M.checked).map(M=>M.value),S={predictor:"simulated",...m,goal:v,free:g,values:u.values(),samples:m.samples??1};return await i.call("add",{settings:S})!==void 0};De("Add sim predictor",[a.element,l,c],[["Cancel",()=>!0],["OK",p]])}function ny(i){let{predictors:t}=i.tables,e=[["Baselines",t.filter(c=>!c.learned)],["Learned",t.filter(c=>c.learned)]],n=_("select",{name:"predictor"},e.map(([c,u])=>_("optgroup",{label:c},u.map(d=>_("option",{value:d.name,selected:d.name==="constant-velocity"},d.name))))),s=_("p",{class:"hint"}),r=_("div",{}),o=null;function a(){let c=tl(t,n.value),u={name:"samples",label:"Futures per person",kind:"whole",value:20,low:1,high:100,note:"drawn as a fan of paths, or as a density"};It(s,c.about),o=On([...c.samples?[u]:[],...c.parameters]),It(r,o.element)}n.addEventListener("change",a),a();let l=async()=>{let{samples:c=1,...u}=o.values(),d={predictor:n.value,samples:c??1,values:u};return await i.call("add",{settings:d})!==void 0};De("Add base predictor",[_("label",{class:"field"},_("span",{},"Predictor"),n),s,r],[["Cancel",()=>!0],["OK",l]])}function iy(i){let{degradations:t}=i.tables,e=_("select",{name:"degradation"},t.map(l=>_("option",{value:l.name,selected:l.name==="gaussian-noise"},l.name))),n=_("p",{class:"hint"}),s=_("div",{}),r=null;function o(){let l=tl(t,e.value);It(n,`${l.about} Usual levels of ${l.level.replaceAll("_"," ")}: ${l.levels.join(", ")}.`),r=On(l.parameters),It(s,r.element)}e.addEventListener("change",o),o();let a=async()=>await i.call("degrade",{name:e.value,values:r.values()})!==void 0;De("Degrade the input",[_("label",{class:"field"},_("span",{},"Degradation"),e),n,s],[["Cancel",()=>!0],["OK",a]])}var tl=(i,t)=>i.find(e=>e.name===t);var sy="http://www.w3.org/2000/svg";function ry(i){let t=_("ul",{class:"predictors","aria-label":"List of predictors"}),e=_("div",{}),n=new Map;return i.on("progress",({key:s,input:r,...o})=>{!r||o.state==="done"||!n.has(s)||It(n.get(s),r==="degraded"?`degraded: ${Xh(o)}`:Xh(o))}),i.on("board",()=>{It(t,i.board.predictors.length?i.board.predictors.map(s=>oA(i,s,n)):_("li",{class:"hint"},"none yet")),It(e,aA(i))}),_("section",{"aria-label":"Predictors"},_("h2",{},"Predictors"),_("div",{class:"buttons"},_("button",{type:"button",onclick:()=>ey(i)},"Add sim predictor\u2026"),_("button",{type:"button",onclick:()=>ny(i)},"Add base predictor\u2026")),t,e)}function $h(i,t="clean"){let{name:e,dash:n}=Cr(i,t),s=document.createElementNS(sy,"svg"),r=document.createElementNS(sy,"line");for(let[o,a]of Object.entries({width:34,height:10,"aria-hidden":"true"}))s.setAttribute(o,a);for(let[o,a]of Object.entries({x1:1,y1:5,x2:33,y2:5,"stroke-width":2.5,"stroke-dasharray":n.join(" ")}))r.setAttribute(o,a);return r.style.stroke=`var(${e})`,s.append(r),s}function oA(i,t,e){let{clean:n,degraded:s}=t.results,r=[n&&Xh(n),s&&`degraded: ${Xh(s)}`].filter(Boolean),o=_("input",{type:"checkbox",checked:!i.hidden.has(t.key),"aria-label":`Draw ${t.label}`});return o.addEventListener("change",()=>i.hide(t.key,!o.checked)),e.set(t.key,_("small",{},r.join("; ")||"not run yet")),_("li",{},o,$h(t.slot),_("span",{class:"name",title:t.name},t.label,e.get(t.key)),t.calibrated&&_("button",{type:"button","aria-label":`Fit\u2026 of ${t.label}`,onclick:()=>lA(i,t.key)},"Fit\u2026"),_("button",{type:"button","aria-label":`Remove ${t.label}`,onclick:()=>i.call("remove",{key:t.key})},"\xD7"))}function Xh({state:i,done:t,windows:e,problem:n,note:s,score:r}){return i==="done"?[`ADE ${r.ade.toFixed(3)} ${r.units}`,s].filter(Boolean).join("; "):i==="failed"?n:i==="waits"?"waits":`${i==="runs"?"running":i}: ${t} of ${e} frames`}function aA(i){let{degradation:t}=i.board,e=_("button",{type:"button",disabled:!i.recording,onclick:()=>iy(i)},"Degrade input\u2026");if(!t)return _("div",{class:"buttons"},e);let n=_("select",{"aria-label":"Input that is drawn"},[_("option",{value:"clean",selected:i.input==="clean"},"as recorded"),_("option",{value:"degraded",selected:i.input==="degraded"},"degraded")]);n.addEventListener("change",()=>i.setInput(n.value));let s=_("button",{type:"button",onclick:()=>i.call("degrade",{name:"",values:{}})},"As recorded only");return _("div",{},_("div",{class:"buttons"},e,s),_("p",{class:"hint"},`Input also: ${t.text}`),_("label",{class:"field"},_("span",{},"Drawn input"),n))}async function lA(i,t){let e=()=>i.board.predictors.find(c=>c.key===t),n=_("div",{}),s=()=>{let c=e();c&&It(n,c.fit?cA(c.fit):_("p",{},"Each frame has its own fit; click a person to see it. Calibrate fits all frames and shows the spread over people."))};s();let r=()=>s();i.addEventListener("board",r);let o=async()=>{let c=await i.call("calibrate_line",{key:t});return c!==void 0&&await $f(c),!1},a=async()=>(await i.call("calibrate",{key:t}),!1);De(`Parameters of ${e().label}`,n,[["Copy as command line",o],["Close",()=>!0],["Calibrate",a]]).addEventListener("close",()=>i.removeEventListener("board",r))}function cA(i){let t=r=>_("td",{class:"number"},r.toPrecision(4)),e=["parameter","median","sd over people","unit"].map(r=>_("th",{scope:"col"},r)),n=i.parameters.map(r=>_("tr",{},_("td",{},r.name),t(r.median),t(r.sd),_("td",{},r.unit))),s=`${i.scheme}: mean cost ${i.cost.toFixed(4)} m, ${i.given_cost.toFixed(4)} m before; ${i.persons} persons in ${i.windows} windows, ${i.evaluations} evaluations, ${i.seconds.toFixed(1)} s`;return _("table",{class:"fit"},_("caption",{},s),_("thead",{},_("tr",{},e)),_("tbody",{},n))}async function $f(i,t="Copy"){let e=_("textarea",{readonly:!0,rows:Math.min(16,i.split(`
`).length+2),cols:78,"aria-label":"Text"});e.value=i;let n="copied to the clipboard";try{await navigator.clipboard.writeText(i)}catch{n="copy the text with Ctrl+C"}De(t,[e,_("p",{class:"hint"},n)]),e.select()}function oy(i,t){let e=_("div",{},_("p",{},"none is open")),n=_("button",{type:"button",onclick:()=>pA(i),disabled:!0},"Time base, units\u2026"),s=_("button",{type:"button",onclick:()=>mA(i),disabled:!0},"Background\u2026"),r=_("section",{"aria-label":"Recording"},_("h2",{},"Recording"),_("div",{class:"buttons"},_("button",{type:"button",onclick:()=>uA(i)},"Open\u2026"),n,s),e,_("p",{class:"hint"},"Files may be dropped anywhere on this tab."));return i.on("board",()=>{let{recording:o}=i;n.disabled=s.disabled=!o,It(e,o?_("dl",{class:"facts"},hA(o)):_("p",{},"none is open"))}),fA(i,t),r}function hA(i){let{summary:t}=i,e=[["File",i.file],["Format",`${i.format} (${i.about})`],["Time base",`${el(i.fps)} frames/s, a row every ${i.frame_step===1?"frame":`${i.frame_step} frames`} = ${el(i.dt)} s`],["Units",`${i.units}, mean speed ${el(t.mean_speed)} ${i.units}/s, largest ${el(t.max_speed)}`],["Content",`${t.tracks} tracks, ${t.rows} rows, ${el(t.seconds)} s, ${i.robots} robots, ${i.walls.length} walls`],["Windows",`${i.windows} of ${i.observe} observed and ${i.predict} predicted rows, protocol ${i.protocol}`]];return i.note&&e.push(["Note",i.note]),e.flatMap(([n,s])=>[_("dt",{},n),_("dd",{},s)])}var el=i=>i===null?"unknown":Number(i.toPrecision(4));async function uA(i){let t=await i.call("files");if(!t)return;let e=_("input",{type:"file","aria-label":"File of this computer"}),n=l=>async()=>await l()!==void 0&&a.close(),s=(l,c,u)=>_("li",{},_("button",{type:"button",onclick:n(u)},l),_("small",{},c)),r=t.files.map(l=>s(l.name,`${dA(l.bytes)}, ${new Date(l.changed*1e3).toLocaleString()}`,()=>i.call("open",{file:l.name}))),o=t.examples.map(l=>s(l.name,l.about,()=>i.call("example",{name:l.name})));e.addEventListener("change",n(()=>ly(i,e.files[0])));let a=De("Open a recording",[_("h3",{},"Example recordings"),_("ul",{class:"files"},o),_("h3",{},"From this computer"),e,_("h3",{},"Recent files"),r.length?_("ul",{class:"files"},r):_("p",{},"The folder of the session has no files yet.")],[["Close",()=>!0]])}var dA=i=>i<1e6?`${Math.ceil(i/1e3)} kB`:`${(i/1e6).toFixed(1)} MB`;async function ay(i,t){let e=`api/${i.app.connection.session}/upload?${new URLSearchParams({name:t.name})}`,n=await fetch(e,{method:"POST",body:t}).catch(s=>({ok:!1,text:()=>s.message}));if(n.ok)return(await n.json()).name;Te(`${t.name}: ${(await n.text()).trim()}`,"error")}async function ly(i,t){let e=t&&await ay(i,t);return e&&i.call("open",{file:e})}function fA(i,t){t.addEventListener("dragover",e=>{e.preventDefault(),t.classList.add("dropping")}),t.addEventListener("dragleave",()=>t.classList.remove("dropping")),t.addEventListener("drop",e=>{e.preventDefault(),t.classList.remove("dropping");let[n]=e.dataTransfer.files;n&&ly(i,n)})}function pA(i){let{options:t,file:e,format:n}=i.recording,s=d=>d.map(h=>[h.name,`${h.name}: ${h.about}`]),{formats:r,protocols:o,time_bases:a}=i.tables,l=On([{name:"format",label:"Format",kind:"choice",value:t.format??"",choices:[["",`found in the content: ${n}`],...s(r)]},{name:"fps",label:"Frames per second of the frame counter",unit:"1/s",kind:"number",value:t.fps,low:0,note:"empty: from the file"},{name:"time_base",label:"Time base of the ETH recording",kind:"choice",value:t.time_base,choices:s(a)},{name:"units",label:"Units of the coordinates in the file",kind:"choice",value:t.units??"",choices:[["","from the file"],"m","cm","mm","px"]},{name:"step",label:"Time step after resampling",unit:"s",kind:"number",value:t.step,low:0,note:"empty: the step of the file"},{name:"observe",label:"Observed rows",kind:"whole",value:t.observe,low:1},{name:"predict",label:"Predicted rows",kind:"whole",value:t.predict,low:1},{name:"protocol",label:"Protocol",kind:"choice",value:t.protocol,choices:s(o)},{name:"every",label:"Use every n-th window",kind:"whole",value:t.every,low:1},{name:"learn",label:"Share of the recording for learning goals",kind:"number",value:t.learn,low:0,high:.99},{name:"near",label:"Score only people this near to a robot",unit:"m",kind:"number",value:t.near,low:0,note:"empty: everybody"},{name:"late",label:"People who appear during the observation",kind:"choice",value:t.late,choices:["skip","extrapolate"]}]),c=i.recording.path,u=async()=>await i.call("open",{file:c,options:l.values()})!==void 0;De(`Time base and units of ${e}`,l.element,[["Cancel",()=>!0],["Load",u]])}function mA(i){let t=_("input",{type:"file",accept:"image/*","aria-label":"Picture"}),e=On([{name:"homography",label:"Homography from (column, row, 1) to the tracks",kind:"text",value:"",note:"nine numbers by rows, or one: metres per pixel; empty: that of the recording"}]),n=async()=>{let[s]=t.files;if(!s)return Te("choose a picture first","error"),!1;let r=await ay(i,s);return r!==void 0&&await i.call("background",{file:r,...e.values()})!==void 0};De("Background picture",[_("label",{class:"field"},_("span",{},"Picture of the ground, from above or from a fixed camera"),t),e.element],[["Cancel",()=>!0],["Show",n]])}function cy(i){let t=_("div",{class:"table-place",tabindex:0,role:"region","aria-label":"Table of metrics"});return i.on("results",({table:e})=>It(t,e.rows.length?gA(e):_("p",{class:"hint"},"No results yet: add a predictor and press Run."))),It(t,_("p",{class:"hint"},"No results yet: add a predictor and press Run.")),_("section",{"aria-label":"Metrics",class:"metrics"},_("h2",{},"Metrics"),t)}function gA({heads:i,rows:t,caption:e,unit:n}){let s=t.some(l=>l.difference!==null),r=l=>_("th",{scope:"col",class:"number"},l),o=_("tr",{},_("th",{scope:"col"},"predictor"),i.map(r),s&&r(`ADE minus as recorded [${n}]`)),a=t.map(l=>_("tr",{"data-key":l.key,"data-input":l.input},_("th",{scope:"row"},$h(l.slot,l.input)," ",l.label,l.input==="degraded"?" (degraded)":"",l.note&&_("small",{},` ${l.note}`)),l.cells.map(c=>_("td",{class:"number"},c)),s&&_("td",{class:"number"},l.difference===null?"-":`${l.difference>0?"+":""}${l.difference.toFixed(3)}`)));return _("table",{},_("caption",{},e),_("thead",{},o),_("tbody",{},a))}function hy(i){let t=_("div",{"aria-live":"polite"}),e=0;async function n(){let r=++e;if(i.person===null||!i.recording){It(t,_("p",{class:"hint"},"Click a person in the scene, or press n."));return}if(!i.frame?.people.some(a=>a.id===i.person)){It(t,_("p",{},`Person ${i.person} is not in this frame.`));return}let o=await i.call("person",{index:i.index,id:i.person});o&&r===e&&It(t,_A(i,o))}let s=null;return i.on("frame person ended",()=>{s??=setTimeout(()=>{s=null,n()},60)}),n(),_("section",{"aria-label":"Person"},_("h2",{},"Person"),t)}var nl=(i,t=3)=>i===null?"-":Number(i).toFixed(t);function _A(i,t){let{units:e}=i.recording,n=t.robot?"Robot":"Person",s=t.scored?"scored":"not scored, since their future is not known for all rows",r=`${n} ${t.id} at (${t.place.map(h=>h.toFixed(2)).join(", ")}) ${e}, ${nl(t.speed,2)} ${e}/s, ${t.rows} observed rows, ${s}`,o=h=>[h.ade,h.fde,h.mean_ade].map(f=>_("td",{class:"number"},nl(f))),a=h=>_("th",{scope:"row"},$h(h.slot,h.input)," ",h.label,h.input==="degraded"?" (degraded)":""),l=["predictor",`ADE [${e}]`,`FDE [${e}]`,"mean ADE"].map((h,f)=>_("th",{scope:"col",class:f?"number":""},h)),c=t.results.length&&_("table",{class:"person-errors"},_("caption",{},"Errors in this frame, and over all frames of this person"),_("thead",{},_("tr",{},l)),_("tbody",{},t.results.map(h=>_("tr",{},a(h),o(h))))),u=(h,f)=>_("button",{type:"button",onclick:()=>i.emit("plot",{variable:h,person:t.id})},f),d=t.results.filter(h=>h.parameters.length).map(h=>yA(h));return[_("p",{},r),c||null,_("div",{class:"buttons"},u("ade","Plot the error of this person")),...d]}function yA(i){let t=["parameter","fit","before","unit"].map((n,s)=>_("th",{scope:"col",class:s===1||s===2?"number":""},n)),e=i.parameters.map(n=>_("tr",{},_("th",{scope:"row"},n.name.replaceAll("_"," ")),_("td",{class:"number"},nl(n.value)),_("td",{class:"number"},nl(n.given)),_("td",{},n.unit)));return _("table",{class:"fit"},_("caption",{},`${i.label}: fit of this frame, cost ${nl(i.cost,4)} m`),_("thead",{},_("tr",{},t)),_("tbody",{},e))}var xA=600,vA=" frame people cost [m]  iter. time [ms] error [m]";function dy(i){let t=On([{name:"seed",label:"Seed",kind:"whole",value:0,low:0},{name:"live",label:"Each fit starts from the frame before (live)",kind:"switch",value:!1}]),e=_("input",{type:"checkbox",checked:!0}),n=_("button",{type:"button",class:"main",onclick:()=>h()},"Run"),s=_("button",{type:"button",disabled:!0,onclick:()=>i.call("cancel")},"Cancel"),r=_("progress",{max:1,value:0,"aria-label":"Progress of the run"}),o=_("span",{role:"status",class:"hint"},""),a=_("pre",{}),l=_("div",{class:"log",tabindex:0,role:"region","aria-label":"Log, one line a frame"},_("pre",{class:"head"},vA),a),c=[],u="",d=0;async function h(){let{seed:v,live:m}=t.values();await i.call("run",{seed:v??0,live:m})}function f({active:v,share:m}){n.disabled=v||!i.recording||!i.board.predictors.length,s.disabled=!v,r.value=m}function p(v,m){v!==u&&m.length&&c.push(v),u=m.length?v:u,c=[...c,...m.map(bA)].slice(-xA),a.textContent=c.join(`
`),l.scrollTop=l.scrollHeight}return i.on("board",()=>f(i.board.run)),i.on("log",v=>{c=[],u="";for(let{key:m,input:g,lines:S}of v)p(uy(i,m,g),S)}),i.on("lines",({key:v,input:m,lines:g})=>{p(uy(i,v,m),g),e.checked&&g.length&&i.go(i.recording.frames.indexOf(g.at(-1)[0]))}),i.on("progress",({share:v})=>{f({active:!0,share:v}),Date.now()-d>1500&&(d=Date.now(),It(o,`${Math.round(100*v)} % done`))}),i.on("ended",({problem:v,cancelled:m})=>{It(o,v||(m?"cancelled; results so far are kept":"done")),v&&Te(v,"error")}),_("section",{"aria-label":"Run"},_("h2",{},"Run"),t.element,_("div",{class:"buttons"},n,s,_("label",{},e,"show the newest frame")),r,o,l)}function uy(i,t,e){return`${i.board.predictors.find(s=>s.key===t)?.label??t}${e==="degraded"?" (degraded)":""}`}function bA([i,t,e,n,s,r]){let o=(l,c,u)=>(l===null?"-":l.toFixed(c)).padStart(u),a=(l,c)=>String(l).padStart(c);return`${a(i,6)} ${a(t,6)} ${o(e,5,8)} ${a(n,6)} ${o(1e3*s,2,9)} ${o(r,3,9)}`}var SA=.25,il=.15;function qf(i,{recording:t,frame:e,layers:n,selected:s,background:r,input:o}){let a=kn("--ink"),l=kn("--faint");if(r&&n.background&&i.picture(r,t.background.bounds),RA(i,t,l),n.walls)for(let c of t.walls)i.line(c,{colour:a,width:2,closed:!0});if(e){if(n.predicted&&n.density)for(let c of e.forecasts)TA(i,c,s);for(let c of e.people)n.observed&&i.line(c.past,{colour:l,width:1.5}),n.truth&&MA(i,c,a);if(e.seen&&n.seen&&o==="degraded")for(let c of e.seen)wA(i,c,kn("--data-5"));if(n.predicted&&!n.density)for(let c of e.forecasts)EA(i,c,e,s,o);AA(i,e,n,s,{ink:a,faint:l})}}function MA(i,t,e){t.truth.length&&(i.line([t.now,...t.truth],{colour:e,width:1.2,dash:[1,3]}),i.square(t.truth.at(-1),2.5,{stroke:e}))}function wA(i,t,e){i.line(t,{colour:e,width:1,dash:[1,2]});for(let n of t)i.square(n,1.2,{fill:e})}function EA(i,{slot:t,paths:e},n,s,r){let o=Xf(t),{dash:a}=Cr(t),l=Math.max(...e.map(u=>u.weight)),c=new Map(n.people.map(u=>[u.id,u.now]));for(let{weight:u,people:d}of e){if(u<=0)continue;let h=e.length>1?.35+.5*u/l:1;for(let{id:f,points:p}of d){let v=s===null||s===f?h:.35*h,m=r==="clean"?c.get(f):null;i.line(m?[m,...p]:p,{colour:o,width:e.length>1?1:2,dash:a,opacity:v}),e.length===1&&i.disc(p.at(-1),2.5,{fill:o,opacity:v})}}}function TA(i,{slot:t,paths:e},n){let s=new Map;for(let{weight:l,people:c}of e)for(let{id:u,points:d}of c)if(!(n!==null&&n!==u))for(let[h,f]of d){let p=`${Math.floor(h/il)} ${Math.floor(f/il)}`;s.set(p,(s.get(p)??0)+l)}let r=Math.max(1e-9,...s.values()),o=.5*il*i.view.scale+.5,a=Xf(t);for(let[l,c]of s){let[u,d]=l.split(" ").map(Number);i.square([(u+.5)*il,(d+.5)*il],o,{fill:a,opacity:.1+.7*Math.sqrt(c/r)})}}function AA(i,t,e,n,{ink:s,faint:r}){let o=Math.max(3,Math.min(14,SA*i.view.scale));for(let a of t.people){let l=a.id===n,c={fill:a.scored?kn("--person"):kn("--panel"),stroke:l?kn("--focus"):s,width:l?3:1};a.robot?i.square(a.now,o,{...c,fill:kn("--robot")}):i.disc(a.now,l?o+1.5:o,c),(e.ids||l)&&i.text(a.now,String(a.id),{colour:e.ids?s:r,dx:o+3,dy:-o})}}function RA(i,t,e){let n=i.view.width/i.view.scale,s=10**Math.floor(Math.log10(n/3)),r=i.view.place(14,i.view.height-14),o=[r[0]+s,r[1]];i.line([r,o],{colour:e,width:2}),i.text(r,`${s} ${t.units}`,{colour:e,dy:-6})}var qh=class{constructor(){Object.assign(this,{x:0,y:0,scale:40,width:600,height:400,down:!1})}fit([t,e,n,s]){this.x=(t+n)/2,this.y=(e+s)/2,this.scale=Math.min(this.width/(n-t),this.height/(s-e))}at([t,e]){let n=this.down?1:-1;return[this.width/2+(t-this.x)*this.scale,this.height/2+n*(e-this.y)*this.scale]}place(t,e){let n=this.down?1:-1;return[this.x+(t-this.width/2)/this.scale,this.y+n*(e-this.height/2)/this.scale]}zoom(t,e=this.width/2,n=this.height/2){let s=this.place(e,n);this.scale=Math.max(.01,Math.min(4e3,this.scale*t));let r=this.place(e,n);this.x+=s[0]-r[0],this.y+=s[1]-r[1]}},Yh=class{constructor(t,e){this.context=t,this.view=e}line(t,{colour:e,width:n=1,dash:s=[],opacity:r=1,closed:o=!1}){if(t.length<2)return;let a=this.context;a.beginPath(),t.forEach((l,c)=>a[c?"lineTo":"moveTo"](...this.view.at(l))),o&&a.closePath(),a.globalAlpha=r,a.strokeStyle=e,a.lineWidth=n,a.setLineDash(s),a.stroke(),a.globalAlpha=1}disc(t,e,{fill:n=null,stroke:s=null,width:r=1,opacity:o=1}){let a=this.context;a.beginPath(),a.arc(...this.view.at(t),e,0,2*Math.PI),this._finish(n,s,r,o)}square(t,e,{fill:n=null,stroke:s=null,width:r=1,opacity:o=1}){let[a,l]=this.view.at(t);this.context.beginPath(),this.context.rect(a-e,l-e,2*e,2*e),this._finish(n,s,r,o)}text(t,e,{colour:n,dx:s=0,dy:r=0}){let[o,a]=this.view.at(t);this.context.font="11px system-ui, sans-serif",this.context.fillStyle=n,this.context.fillText(e,o+s,a+r)}picture(t,[e,n,s,r]){let[o,a]=this.view.at([e,this.view.down?n:r]),{scale:l}=this.view;this.view.down?(this.context.save(),this.context.translate(o,a+(r-n)*l),this.context.scale(1,-1),this.context.drawImage(t,0,0,(s-e)*l,(r-n)*l),this.context.restore()):this.context.drawImage(t,o,a,(s-e)*l,(r-n)*l)}_finish(t,e,n,s){let r=this.context;r.globalAlpha=s,r.setLineDash([]),t&&(r.fillStyle=t,r.fill()),e&&(r.strokeStyle=e,r.lineWidth=n,r.stroke()),r.globalAlpha=1}},Zh=class{constructor(t,e){this.view=t,this.parts=[`<rect width="${t.width}" height="${t.height}" fill="${e}"/>`]}line(t,{colour:e,width:n=1,dash:s=[],opacity:r=1,closed:o=!1}){if(t.length<2)return;let a=t.map(u=>this.view.at(u).map(is).join(",")).join(" "),l=s.length?` stroke-dasharray="${s.join(" ")}"`:"",c=o?"polygon":"polyline";this.parts.push(`<${c} points="${a}" fill="none" stroke="${e}" stroke-width="${n}"${l}${py(r)}/>`)}disc(t,e,n){let[s,r]=this.view.at(t).map(is);this.parts.push(`<circle cx="${s}" cy="${r}" r="${is(e)}"${fy(n)}/>`)}square(t,e,n){let[s,r]=this.view.at(t);this.parts.push(`<rect x="${is(s-e)}" y="${is(r-e)}" width="${is(2*e)}" height="${is(2*e)}"${fy(n)}/>`)}text(t,e,{colour:n,dx:s=0,dy:r=0}){let[o,a]=this.view.at(t),l=e.replace(/[&<>"]/g,c=>`&#${c.charCodeAt(0)};`);this.parts.push(`<text x="${is(o+s)}" y="${is(a+r)}" fill="${n}" font-size="11" font-family="sans-serif">${l}</text>`)}picture(){}toString(){let{width:t,height:e}=this.view;return`<svg xmlns="http://www.w3.org/2000/svg" width="${t}" height="${e}" viewBox="0 0 ${t} ${e}">
${this.parts.join(`
`)}
</svg>
`}},is=i=>Math.round(i*100)/100,py=i=>i===1?"":` opacity="${is(i)}"`;function fy({fill:i=null,stroke:t=null,width:e=1,opacity:n=1}){let s=t?` stroke="${t}" stroke-width="${e}"`:"";return` fill="${i??"none"}"${s}${py(n)}`}var CA=18,Kh=class{constructor(t){this.store=t,this.view=new qh,this.background=null,this.canvas=_("canvas",{tabindex:0,role:"img","aria-label":"Scene",class:"scene"}),this.summary=_("p",{class:"summary","aria-live":"polite"},""),this.element=_("div",{class:"scene-place"},this.canvas),new ResizeObserver(()=>this._resize()).observe(this.element),t.on("board",e=>this._board(e)),t.on("frame person view",()=>this.draw()),t.on("frame",()=>this._tell()),document.addEventListener("theme",()=>this.draw()),this._listen()}fit(){this.store.recording&&(this.view.fit(this.store.recording.bounds),this.draw())}draw(){this._waits??=requestAnimationFrame(()=>{this._waits=null,this._draw()})}png(){return this._draw(),new Promise(t=>this.canvas.toBlob(t,"image/png"))}svg(){let t=new Zh(this.view,kn("--paper"));return qf(t,this._content()),t.toString()}pick(t,e){let n=null,s=CA;for(let r of this.store.frame?.people??[]){let[o,a]=this.view.at(r.now),l=Math.hypot(o-t,a-e);l<s&&([n,s]=[r.id,l])}return n}step(t){let e=(this.store.frame?.people??[]).map(s=>s.id);if(!e.length)return;let n=e.indexOf(this.store.person);this.store.choose(e[n<0?0:(n+t+e.length)%e.length])}_content(){let{recording:t,frame:e,layers:n,person:s,input:r}=this.store;return{recording:t,frame:e,layers:n,selected:s,background:this.background,input:r}}_draw(){let t=devicePixelRatio||1,e=this.canvas.getContext("2d");e.setTransform(t,0,0,t,0,0),e.fillStyle=kn("--paper"),e.fillRect(0,0,this.view.width,this.view.height),this.store.recording&&qf(new Yh(e,this.view),this._content()),this.canvas.dataset.frame=this.store.frame?.index??"",this.canvas.dataset.forecasts=this.store.frame?.forecasts.length??0}_resize(){let{clientWidth:t,clientHeight:e}=this.element;if(!t||!e)return;let n=devicePixelRatio||1,s=this.view.width===600&&this.view.height===400;Object.assign(this.view,{width:t,height:e}),this.canvas.width=t*n,this.canvas.height=e*n,(s||!this._moved)&&this.fit(),this._draw()}_board(t){let{recording:e}=this.store;this.view.down=e?.units==="px";let n=JSON.stringify(e?.background??null);n!==this._backgroundName&&this._loadBackground(n),t&&(this._moved=!1,this.fit()),this.draw()}_loadBackground(t){if(this._backgroundName=t,this.background=null,t==="null")return;let e=new Image;e.onload=()=>{this.background=e,this._moved=!1,this.fit()},e.src=this.store.app.connection.address("prediction","background.png",{name:t})}_tell(){let{frame:t,recording:e}=this.store,n=t.people.filter(o=>o.scored).length,s=t.people.filter(o=>o.robot).length,r=`Frame ${e.frames[t.index]}, ${t.time.toFixed(2)} s: ${t.people.length-s} people, ${s} robots, ${n} scored, ${t.forecasts.length} predictors`;this.canvas.setAttribute("aria-label",`Scene. ${r}`),clearTimeout(this._later),this._later=setTimeout(()=>It(this.summary,r),400)}_listen(){let t=null,e=!1;this.canvas.addEventListener("pointerdown",n=>{t=[n.offsetX,n.offsetY],e=!1,this.canvas.setPointerCapture(n.pointerId)}),this.canvas.addEventListener("pointermove",n=>{if(!t)return;let[s,r]=[n.offsetX-t[0],n.offsetY-t[1]];!e&&Math.hypot(s,r)<4||(e=this._moved=!0,this._shift(-s,-r),t=[n.offsetX,n.offsetY])}),this.canvas.addEventListener("pointerup",n=>{t&&!e&&this.store.choose(this.pick(n.offsetX,n.offsetY)),t=null}),this.canvas.addEventListener("wheel",n=>{n.preventDefault(),this._moved=!0,this.view.zoom(Math.exp(-n.deltaY*.0015),n.offsetX,n.offsetY),this.draw()},{passive:!1})}_shift(t,e){this.view.x+=t/this.view.scale,this.view.y+=(this.view.down?1:-1)*e/this.view.scale,this.draw()}zoom(t){this._moved=!0,this.view.zoom(t),this.draw()}};var PA={frame:"index",person:"person"},Jh=class extends EventTarget{constructor(t){super(),this.app=t,this.board={recording:null,predictors:[],degradation:null,run:{active:!1,share:0}},this.tables=null,this.index=0,this.person=null,this.frame=null,this.hidden=new Set,this.layers={walls:!0,background:!0,observed:!0,truth:!0,predicted:!0,ids:!1,density:!1,seen:!0},this.input="clean",this._loading=null;for(let[e,n]of Object.entries(PA)){let s=t.address.get(e);/^\d+$/.test(s??"")&&(this[n]=Number(s))}}call(t,e={}){return ve(()=>this.app.connection.call(`prediction.${t}`,e))}get recording(){return this.board.recording}take(t){let e=this.recording;this.board=t;let n=t.recording,s=e?.file!==n?.file||JSON.stringify(e?.options)!==JSON.stringify(n?.options);t.degradation||(this.input="clean"),n&&(this.index=Math.min(this.index,n.windows-1)),s&&e&&(this.index=0,this.person=null),this.emit("board",s),n&&this.load()}go(t){return this.recording?(this.index=Math.max(0,Math.min(this.recording.windows-1,Math.round(t))),this.app.remember({frame:this.index}),this.emit("index"),this.load()):Promise.resolve()}choose(t){this.person=t,this.app.remember({person:t}),this.emit("person")}show(t,e){this.layers[t]=e,this.emit("view")}setInput(t){this.input=t,this.load(),this.emit("view")}hide(t,e){e?this.hidden.add(t):this.hidden.delete(t),this.load()}load(){return this._wanted=!0,this._loading??=this._fetch().finally(()=>this._loading=null),this._loading}async _fetch(){for(;this._wanted;){this._wanted=!1;let t=this.index,e={index:t,input:this.input,hide:[...this.hidden].join(",")},n=await fetch(this.app.connection.address("prediction","window",e)).catch(()=>null);if(!n?.ok)return;this.frame=IA(Ps(await n.arrayBuffer()),this.recording,t),this.emit("frame")}}emit(t,e){this.dispatchEvent(new CustomEvent(t,{detail:e}))}on(t,e){for(let n of t.split(" "))this.addEventListener(n,s=>e(s.detail))}};function IA({arrays:i,time:t},e,n){let s=[...i.ids].map((a,l)=>({id:a,robot:(i.kind[l]&1)===1,scored:(i.kind[l]&2)===2,past:Yf(i.past,l*e.observe,e.observe),truth:Yf(i.truth,l*e.predict,e.predict)}));for(let a of s)a.now=a.past.at(-1);let r=Object.keys(i).filter(a=>a.startsWith("path.")).map(a=>LA(Number(a.slice(5)),i,e.predict)),o=i.seen?DA(i.seen,e.observe):null;return{index:n,time:t,people:s,forecasts:r,seen:o}}function LA(i,t,e){let n=[...t[`ids.${i}`]],s=[...t[`mass.${i}`]],r=t[`path.${i}`],o=s.map((a,l)=>({weight:a,people:n.map((c,u)=>({id:c,points:Array.from({length:e},(d,h)=>{let f=2*((l*e+h)*n.length+u);return[r[f],r[f+1]]})}))}));return{slot:i,ids:n,paths:o}}function DA(i,t){return Array.from({length:i.length/2/t},(e,n)=>Yf(i,n*t,t))}function Yf(i,t,e){let n=[];for(let s=t;s<t+e;s++)Number.isFinite(i[2*s])&&n.push([i[2*s],i[2*s+1]]);return n}var NA=[["observed","Observed"],["truth","True"],["predicted","Predicted"],["density","Density"],["walls","Walls"],["background","Ground"],["ids","Numbers"]];function _y(i,t){let e=NA.map(([s,r])=>{let o=_("input",{type:"checkbox",checked:i.layers[s]});return o.addEventListener("change",()=>i.show(s,o.checked)),_("label",{},o,r)}),n=_("select",{"aria-label":"Export or copy"},[_("option",{value:""},"Export or copy\u2026"),...my(i,t).map(([s,r])=>_("option",{value:s},r))]);return n.addEventListener("change",()=>{let s=my(i,t).find(([r])=>r===n.value);n.value="",i.recording?s?.[2]():Te("open a recording first","error")}),_("div",{class:"toolbar",role:"group","aria-label":"Scene"},_("span",{class:"layers"},e),_("button",{type:"button",onclick:()=>t.fit()},"Fit"),_("button",{type:"button","aria-label":"Zoom in",onclick:()=>t.zoom(1.25)},"+"),_("button",{type:"button","aria-label":"Zoom out",onclick:()=>t.zoom(.8)},"\u2212"),n)}function my(i,t){let e=()=>`${i.recording.file}-${i.recording.frames[i.index]}`;return[["command","Copy as command line",()=>gy(i,"command_line")],["python","Copy as Python",()=>gy(i,"python")],["png","Scene as PNG",async()=>Zf(await t.png(),`${e()}.png`)],["svg","Scene as SVG",()=>Zf(new Blob([t.svg()],{type:"image/svg+xml"}),`${e()}.svg`)],["gif","This frame as animation (GIF)",()=>jh(i,"animation.gif",{index:i.index})],["frames.csv","Results by frame as CSV",()=>jh(i,"frames.csv")],["people.csv","Results by person as CSV",()=>jh(i,"people.csv")],["frames.parquet","Results by frame as Parquet",()=>jh(i,"frames.parquet")]]}async function gy(i,t){let e=i.input==="degraded",n=await i.call(t,{degraded:e});n!==void 0&&await $f(n,t==="python"?"Copy as Python":"Copy as command line")}async function jh(i,t,e={}){let n=await fetch(i.app.connection.address("prediction",t,e)).catch(r=>({ok:!1,text:()=>r.message}));if(!n.ok)return Te((await n.text()).trim(),"error");let s=/filename="([^"]+)"/.exec(n.headers.get("Content-Disposition")??"")?.[1]??t;return Zf(await n.blob(),s)}function Zf(i,t){let e=_("a",{href:URL.createObjectURL(i),download:t});e.click(),setTimeout(()=>URL.revokeObjectURL(e.href),1e4)}var UA=[.25,.5,1,2,4,8],Qh=class{constructor(t){this.store=t,this.playing=!1,this.speed=_("select",{"aria-label":"Speed"},UA.map(e=>_("option",{value:e,selected:e===1},`${e}\xD7`))),this.slider=_("input",{type:"range",min:0,max:0,value:0,"aria-label":"Frame",oninput:()=>t.go(Number(this.slider.value))}),this.button=this._button("Play",()=>this.toggle()),this.jump=_("input",{type:"number","aria-label":"Jump to frame",step:1,onchange:()=>this.jumpTo(Number(this.jump.value))}),this.words=_("span",{class:"position"},""),this.element=_("div",{class:"transport",role:"group","aria-label":"Playback"},this._button("First",()=>t.go(0)),this._button("Back",()=>this.step(-1)),this.button,this._button("Step",()=>this.step(1)),this._button("Last",()=>t.go(1/0)),this.slider,this.words,_("label",{},"Jump to",this.jump),this.speed),t.on("board index frame",()=>this._update())}step(t){return this.pause(),this.store.go(this.store.index+t)}jumpTo(t){let e=this.store.recording?.frames??[],n=0;return e.forEach((s,r)=>{Math.abs(s-t)<Math.abs(e[n]-t)&&(n=r)}),this.store.go(n)}toggle(){this.playing?this.pause():this.play()}pause(){this.playing=!1,clearTimeout(this._timer),It(this.button,"Play")}async play(){let{store:t}=this;t.recording&&(this.playing=!0,It(this.button,"Pause"),t.index>=t.recording.windows-1&&await t.go(0),this._next())}_next(){let{frames:t,fps:e}=this.store.recording,n=(t[this.store.index+1]-t[this.store.index])/e,s=1e3*Math.min(2,n||0)/Number(this.speed.value);this._timer=setTimeout(async()=>{this.playing&&(await this.store.go(this.store.index+1),this.store.index>=this.store.recording.windows-1?this.pause():this.playing&&this._next())},s)}_update(){let{recording:t,index:e}=this.store,n=!t;for(let r of this.element.querySelectorAll("button, input, select"))r.disabled=n;if(n)return;this.slider.max=t.windows-1,this.slider.value=e,this.slider.setAttribute("aria-valuetext",`frame ${t.frames[e]}`);let s=(t.frames[e]-t.frames[0])/t.fps;It(this.words,`frame ${t.frames[e]}, ${s.toFixed(2)} s, ${e+1} of ${t.windows}`)}_button(t,e){return _("button",{type:"button",onclick:e},t)}};var yy={name:"prediction",title:"Prediction",mount(i,t){let e=new Jh(t),n=new Kh(e),s=new Qh(e);return i.classList.add("prediction"),i.append(_("div",{class:"side"},oy(e,i),ry(e),dy(e)),_("div",{class:"middle"},_y(e,n),n.element,n.summary,s.element,cy(e)),_("div",{class:"side"},hy(e),Q_(e))),kA(t,e,n,s),OA(t,e),{store:e,scene:n,hide:()=>s.pause(),show:()=>n.draw(),greet:r=>FA(e,r)}}};async function FA(i,t){i.tables??=await i.call("tables"),i.take(t);let e=await i.call("log");e&&i.emit("log",e)}function OA(i,t){i.connection.on("prediction.board",e=>t.take(e));for(let e of["lines","progress","ended","note"])i.connection.on(`prediction.${e}`,n=>{e==="progress"&&(t.board.run={active:!0,share:n.share}),t.emit(e,n),(e==="lines"||e==="ended")&&t.load()})}function kA(i,t,e,n){i.keys.add("prediction",[[" ","Play or pause",()=>n.toggle()],["ArrowRight","Next frame",()=>n.step(1)],["ArrowLeft","Previous frame",()=>n.step(-1)],["Home","First frame",()=>t.go(0)],["End","Last frame",()=>t.go(1/0)],["n","Next person",()=>e.step(1)],["p","Previous person",()=>e.step(-1)],["Escape","No person",()=>t.choose(null)],["f","Fit the scene",()=>e.fit()],["+","Zoom in",()=>e.zoom(1.25)],["-","Zoom out",()=>e.zoom(.8)]])}var tu=class{constructor(t,e){this.app=t,this.picture=e;let n=[["3d","In space"],["2d","From above"]];this.view=_("select",{"aria-label":"View",onchange:()=>this._chooseView()},n.map(([s,r])=>_("option",{value:s,selected:s===e.view},r))),this.camera=_("select",{"aria-label":"Camera",onchange:()=>this.look(this.camera.value)}),this.boxes=_("div",{class:"choice"}),this.element=_("details",{open:!0},_("summary",{},"Display"),_("div",{class:"row"},this.view,this.camera),this.boxes),this._hidden=new Set((t.address.get("hide")??"").split(",").filter(Boolean)),this._extra=new Set((t.address.get("show")??"").split(",").filter(Boolean))}loaded(){let{scene:t}=this.picture;It(this.camera,t.cameras().map(e=>_("option",{value:e.name,selected:e.name===t.camera},e.title)));for(let{name:e,visible:n}of t.layers())n&&this._hidden.has(e)&&t.setLayer(e,!1),!n&&this._extra.has(e)&&t.setLayer(e,!0);It(this.boxes,t.layers().map(({name:e,title:n,visible:s})=>{let r=_("input",{type:"checkbox",checked:s,onchange:()=>this._toggle(e,r.checked)});return _("label",{},r,n)})),this._want()}look(t){let{scene:e}=this.picture;e.cameras().some(n=>n.name===t)&&(e.setCamera(t),this.camera.value=t,this.picture.wake())}reset(){this.picture.scene.reset(),this.camera.value=this.picture.scene.camera,this.picture.wake()}_chooseView(){this.picture.setView(this.view.value)}_toggle(t,e){this.picture.scene.setLayer(t,e),this._hidden[e?"delete":"add"](t),this._extra[e?"add":"delete"](t),this.app.remember({hide:[...this._hidden].join(",")||null,show:[...this._extra].join(",")||null}),this.picture.wake(),this._want()}_want(){this.app.connection.call("simulator.layers",{names:this.picture.scene.wanted()}).catch(()=>{})}};var BA=100,zA=.12,xy={ArrowUp:[1,0,0],w:[1,0,0],ArrowDown:[-1,0,0],s:[-1,0,0],ArrowLeft:[0,1,0],a:[0,1,0],ArrowRight:[0,-1,0],d:[0,-1,0],q:[0,0,1],e:[0,0,-1]},eu=class{constructor(t,e){this.app=t,this.actions=e,this.subject=null,this.limits={speed:.6,turn:1.2},this._down=new Set,this._stick=[0,0],this._sent="",this.knob=_("div",{class:"knob"}),this.pad=_("div",{class:"joystick",role:"img","aria-label":"Joystick: drag to drive; the keys W A S D or arrows do the same"},this.knob),this.text=_("p",{role:"status"}),this.stopButton=_("button",{type:"button",onclick:()=>this.stop()},"Give back"),this.element=_("div",{class:"drive",hidden:!0},this.text,this.pad,this.stopButton),this._listen()}async start(t,e){await this.stop(),!(t==="robot"&&await ve(()=>this.app.connection.call("simulator.take_over",{robot:e}).then(()=>!0))!==!0)&&(this.subject={kind:t,name:e},this.element.hidden=!1,this.text.textContent=`You move ${e}: arrows or W A S D${t==="robot"?"":", Q and E sideways"}, the joystick, or a gamepad. Escape gives back.`,this.stopButton.textContent=t==="robot"?"Give back":"Stand still",this._sent="",document.activeElement?.blur?.(),this._timer=setInterval(()=>this._send(),BA),this.actions.started(this.subject))}async stop(){let{subject:t}=this;t&&(this.forget(),t.kind==="robot"?await ve(()=>this.app.connection.call("simulator.release",{robot:t.name})):await ve(()=>this.app.connection.call("simulator.walk",{avatar:t.name,forward:0})))}forget(){clearInterval(this._timer),this.subject=null,this._down.clear(),this.element.hidden=!0,this.actions.stopped()}input(){let t=[0,0,0];for(let s of this._down)xy[s].forEach((r,o)=>t[o]+=r);let[e,n]=this._stick;t[0]-=n,t[1]-=e;for(let s of navigator.getGamepads?.()??[]){if(!s)continue;let r=o=>Math.abs(s.axes[o]??0)>zA?s.axes[o]:0;t[0]-=r(1),t[1]-=r(2)||r(0),t[2]-=r(2)?r(0):0}return t.map(s=>Math.max(-1,Math.min(1,s)))}_send(){if(!this.subject||!this.app.connection.open)return;let{kind:t,name:e}=this.subject,[n,s,r]=this.input(),[o,a]=t==="robot"?["drive",{robot:e,forward:this.limits.speed*n,turn:this.limits.turn*s,left:this.limits.speed*r}]:["walk",{avatar:e,forward:1.5*n,turn:2*s,left:1.2*r}];this.app.connection.call(`simulator.${o}`,a).catch(()=>this.forget())}_listen(){let t=n=>!this.subject||n.target.closest?.("input, textarea, select, dialog");document.addEventListener("keydown",n=>{n.key==="Escape"&&this.subject&&this.stop();let s=n.key.length===1?n.key.toLowerCase():n.key;t(n)||!(s in xy)||n.ctrlKey||n.metaKey||n.altKey||n.shiftKey||(n.preventDefault(),this._down.add(s))},!0),document.addEventListener("keyup",n=>this._down.delete(n.key.length===1?n.key.toLowerCase():n.key),!0),addEventListener("blur",()=>this._down.clear());let e=n=>{let{left:s,top:r,width:o,height:a}=this.pad.getBoundingClientRect(),[l,c]=[2*(n.clientX-s)/o-1,2*(n.clientY-r)/a-1],u=Math.max(1,Math.hypot(l,c));this._place(l/u,c/u)};this.pad.addEventListener("pointerdown",n=>{this.pad.setPointerCapture(n.pointerId),e(n)}),this.pad.addEventListener("pointermove",n=>this.pad.hasPointerCapture(n.pointerId)&&e(n));for(let n of["pointerup","pointercancel"])this.pad.addEventListener(n,()=>this._place(0,0))}_place(t,e){this._stick=[t,e],this.knob.style.transform=`translate(${38*t}px, ${38*e}px)`}};var nu=class{constructor(t,e){this.app=t,this.parts=e,this.events=[],this.list=_("ol",{class:"events"}),this.branch=_("button",{type:"button",onclick:()=>this._dialog()},"Branch from here\u2026"),this.share=_("progress",{"aria-label":"Progress of the branch",max:1,value:0,hidden:!0}),this.element=_("details",{open:!0,hidden:!0},_("summary",{},"Episode"),this.branch,this.share,_("p",{class:"faint"},"Keys J and K jump to the event before and after"),this.list),t.connection.on("simulator.branch",n=>this._progress(n))}show(t){this.events=t,It(this.list,t.map(e=>_("li",{class:e.kind.replace(" ","-")},_("button",{type:"button",onclick:()=>this.parts.transport.seek(e.time)},`${e.time.toFixed(1)} s  ${e.kind}: ${e.about}`)))),t.length||It(this.list,_("li",{class:"faint"},"No contact, near miss or stall"))}jump(t){let e=this.parts.transport.status.time,n=this.events.filter(r=>t>0?r.time>e+.05:r.time<e-.05),s=t>0?n[0]:n.at(-1);s&&this.parts.transport.seek(s.time)}_dialog(){let t=this.parts.transport.status.time,e=On([{name:"navigator",label:"Navigator of the robot",kind:"choice",value:"",choices:[["","as recorded"],...this.parts.names().navigators]},{name:"more",label:"Other values, such as robot/drive/max-speed=0.3",kind:"text",value:""}]),n=async()=>{let{navigator:s,more:r}=e.values(),o=Object.fromEntries(r.split(/\s+/).filter(Boolean).map(a=>[a.split("=")[0],a.slice(a.indexOf("=")+1)]));return s&&(o["robot/navigator/type"]=s),await ve(()=>this.app.connection.call("simulator.branch",{at:t,changes:o}))!==void 0};De(`Branch at ${t.toFixed(1)} s`,e.element,[["Cancel",()=>!0],["Branch",n]])}async _progress({name:t,share:e,done:n,error:s,at:r,outcome:o}){if(this.share.hidden=n===!0||s!==void 0,this.share.value=e??0,s)return Te(s,"error");if(n)return Te(`${t}: ${o}`),await this.parts.library.loadEpisodes(),this.parts.library.openEpisode(t,r)}};var vy=.3,iu=class{constructor(t,e){this.app=t,this.actions=e,this.chosen=null,this.live=!1,this.navigators=[],this.list=_("select",{"aria-label":"Choose a person or robot",onchange:()=>this._choose(),onfocus:()=>this.refresh()}),this.table=_("tbody"),this.buttons=_("div",{class:"buttons"}),this.x=_("input",{type:"number",step:"any","aria-label":"x [m]"}),this.y=_("input",{type:"number",step:"any","aria-label":"y [m]"}),this.place=_("div",{class:"place"},_("span",{},"x, y [m]"),this.x,this.y,_("button",{type:"button",onclick:()=>this.goal(this._point())},"Set goal"),_("button",{type:"button",onclick:()=>this.move(this._point())},"Move there")),this.element=_("details",{open:!0},_("summary",{},"Inspector"),this.list,_("table",{},this.table),this.buttons,this.place),this._show(null)}async refresh(){let t=await this.app.connection.call("simulator.people").catch(()=>[]),e=n=>`${n.kind} ${n.name||n.id}`;It(this.list,_("option",{value:""},"nobody chosen"),t.map(n=>_("option",{value:`${n.kind} ${n.id}`},e(n)))),this.list.value=this.chosen?`${this.chosen.kind} ${this.chosen.id}`:""}async select(t){return this.chosen=t,this.actions.chosen(t),await this.refresh(),this.update()}async update(){if(!(!this.chosen||this._asking)){this._asking=!0;try{this._show(await this.app.connection.call("simulator.inspect",{id:this.chosen.id}))}catch{this._show(null)}finally{this._asking=!1}}}goal(t){if(!this.state||!t)return;let{kind:e,id:n,name:s}=this.state;this.order(e==="robot"?{order:"goal",robot:s,...t}:{order:"redirect",person:n,...t})}move(t){this.state&&t&&this.order({order:"move",person:this.state.id,...t})}remove(){if(!this.state)return;let{kind:t,id:e,name:n}=this.state;this.order(t==="robot"?{order:"remove-element",path:`robot[${n}]`}:{order:"remove",person:e}),this.select(null)}order(t){return ve(()=>this.app.connection.call("simulator.order",{order:t})).then(()=>this.update())}_choose(){let[t,e]=this.list.value.split(" ");this.select(t?{kind:t,id:Number(e)}:null)}_point(){return this.x.value===""||this.y.value===""?null:{x:Number(this.x.value),y:Number(this.y.value)}}_show(t){let e=this.state&&`${this.state.kind} ${this.state.id}`;this.state=t,It(this.table,(t?.rows??[]).map(([s,r,o])=>_("tr",{},_("th",{scope:"row"},s),_("td",{},o?`${r} ${o}`:String(r))))),this.place.hidden=!t||!this.live;let n=t&&`${t.kind} ${t.id} ${this.live}`;n!==this._made&&(this._made=n,t&&e!==`${t.kind} ${t.id}`&&([this.x.value,this.y.value]=t.goal.map(s=>s.toFixed(2))),It(this.buttons,t&&this.live?this._buttons(t):[]))}_buttons({kind:t,name:e,values:n}){let s=(c,u)=>_("button",{type:"button",onclick:u},c),r=(c,u,d)=>s(c,()=>this.move({x:this.state.x+vy*u,y:this.state.y+vy*d})),o=[s("Goal by click",()=>this.actions.tool("goal")),s("Move by click",()=>this.actions.tool("move")),s("Parameters",()=>this.actions.values(n)),s("Remove",()=>this.remove())];if(t==="person"){let c=[r("Push +x",1,0),r("Push \u2212x",-1,0),r("Push +y",0,1),r("Push \u2212y",0,-1)];return e&&o.push(s("Walk as this person",()=>this.actions.drive("avatar",e))),[...o,...c]}let a=_("select",{"aria-label":"Navigator",onchange:()=>this._navigator(a.value)},this.navigators.map(c=>_("option",{},c))),l=this.state.rows.find(([c])=>c==="navigator");return a.value=l?l[1]:"",[...o,s("Drive",()=>this.actions.drive("robot",e)),_("label",{class:"field"},_("span",{},"Navigator"),a)]}_navigator(t){this.order({order:"parameter",path:`robot[${this.state.name}]/navigator/type`,value:t})}};var su=class{constructor(t){this.app=t,this.trials=_("ul",{class:"trials"}),this.episodes=_("ul",{class:"episodes"}),this.search=_("input",{type:"search","aria-label":"Search trials",placeholder:"Search trials",oninput:()=>this._filter()}),this.file=_("input",{type:"file",accept:".xml,.mcap","aria-label":"Open a trial or an episode from a file",onchange:()=>this._upload()}),this.element=_("aside",{class:"library","aria-label":"Trials and episodes"},_("h2",{},"Trials"),this.search,this.trials,_("h2",{},"Episodes"),this.episodes,_("label",{class:"field"},_("span",{},"Open a file (.xml, .mcap)"),this.file))}async load(){let[t]=await Promise.all([this.app.connection.call("simulator.trials"),this.loadEpisodes()]);It(this.trials,t.map(e=>this._trial(e))),this._filter()}async loadEpisodes(){let t=await this.app.connection.call("simulator.episodes");It(this.episodes,t.length?t.map(e=>_("li",{},_("button",{type:"button",onclick:()=>this.openEpisode(e)},e))):_("li",{class:"faint"},"None yet: save a run"))}openEpisode(t,e=null){return ve(()=>this.app.connection.call("simulator.open_episode",{name:t,at:e}))}async open(t,e={},n=null){let s=await ve(()=>this.app.connection.call("simulator.open",{name:t,settings:e,seed:n}));for(let r of s?.remarks??[])Te(r);return s}mark(t){for(let e of this.element.querySelectorAll("button[aria-current]"))e.removeAttribute("aria-current");this.trials.querySelector(`button[data-name="${CSS.escape(t??"")}"]`)?.setAttribute("aria-current","true")}_trial({name:t,title:e,built_in:n,parameters:s}){let r=n&&_("img",{src:this.app.connection.address("simulator",`thumbnail/${t}.svg`),alt:"",loading:"lazy"}),o=_("button",{type:"button","data-name":t,title:e,onclick:()=>this.open(t)},r||null,_("span",{},_("strong",{},t),_("small",{},e))),a=s.length?_("button",{type:"button",class:"more","aria-label":`Settings of ${t}`,onclick:()=>this._settings(t,s)},"Settings"):null;return _("li",{"data-words":`${t} ${e}`.toLowerCase()},o,a)}_settings(t,e){let n=On([...e,{name:"world",label:"World",kind:"choice",value:"",choices:[["","as in the trial"],"planar","physics"]}]),s=async()=>{let r=Object.fromEntries(e.map(l=>[l.name,l.value])),o=n.values(),a=Object.fromEntries(Object.entries(o).filter(([l,c])=>c!==""&&c!==null&&c!==r[l]));return await this.open(t,a)!==void 0};De(`Settings of ${t}`,n.element,[["Cancel",()=>!0],["Run",s]])}_filter(){let t=this.search.value.toLowerCase().split(/\s+/).filter(Boolean);for(let e of this.trials.children)e.hidden=!t.every(n=>e.dataset.words.includes(n))}async _upload(){let t=this.file.files[0];t&&(await ve(async()=>{let{session:e}=this.app.connection,n=await fetch(`api/${e}/upload?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t});if(!n.ok)throw new Error((await n.text()).trim());let{name:s}=await n.json();await(s.endsWith(".mcap")?this.openEpisode(s):this.open(s)),await this.load()}),this.file.value="")}};var by=3e3,Sy=["--data-1","--data-2","--data-3","--data-4","--data-5","--data-6"],HA=[[],[8,4],[2,3],[8,3,2,3],[12,4],[4,4]],GA=400,ru=class{constructor(t){this.app=t,this.kinds=[],this.metrics=[],this.rows=[],this.chosen=new Set((t.address.get("plots")??"clearance,speed").split(",").filter(Boolean)),this.plots=new Map,this._drawn=0,this.choice=_("fieldset",{class:"choice"},_("legend",{},"Plots")),this.metric=_("select",{"aria-label":"Add a metric of the run",onchange:()=>this._add()}),this.area=_("div"),this.element=_("details",{open:!0},_("summary",{},"Plots"),this.area,this.choice,this.metric)}know(t){this.kinds=t,this._listChoice()}begin(t){this.rows=t.map(([e,n])=>[e,n]),this._draw(!0)}whole(t){let e=Object.keys(t).filter(n=>n!=="time");this.rows=t.time.map((n,s)=>[n,Object.fromEntries(e.map(r=>[r,t[r][s]]))]),this._draw(!0)}take(t){let e=Object.keys(t.metrics??{}).sort();if(e.join()!==this.metrics.join()&&(this.metrics=e,It(this.metric,_("option",{value:""},"Add a metric of the run\u2026"),e.map(r=>_("option",{},r)))),t.kind==="episode"){for(let r of this.plots.values())r.mark(t.time);return}if(t.state==="preparing"||!Object.keys(t.values??{}).length)return;let n=this.rows.at(-1);if(n&&n[0]>=t.time)return;let s=Object.fromEntries(Object.entries(t.metrics).filter(([r])=>this.chosen.has(r)));this.rows.push([t.time,{...s,...t.values}]),this.rows.length>by&&(this.rows=this.rows.filter((r,o)=>o%2||o>by/2)),this._draw(!1)}_listChoice(){let t=this.kinds.map(({name:e,title:n})=>{let s=_("input",{type:"checkbox",checked:this.chosen.has(e),onchange:()=>this._toggle(e,s.checked)});return _("label",{},s,n)});It(this.choice,_("legend",{},"Show"),t)}_add(){this.metric.value&&this._toggle(this.metric.value,!this.chosen.has(this.metric.value)),this.metric.value=""}_toggle(t,e){e?this.chosen.add(t):this.chosen.delete(t),this.app.remember({plots:[...this.chosen].join(",")}),this._draw(!0)}_draw(t){if(!(!this.element.open||!this.element.isConnected)&&!(!t&&performance.now()-this._drawn<GA)){this._drawn=performance.now();for(let[e,n]of this.plots)this.chosen.has(e)||(n.destroy(),this.plots.delete(e));for(let e of this.chosen)this.plots.has(e)||this.plots.set(e,this._make(e)),this.plots.get(e).set([this.rows.map(([n])=>n),this.rows.map(([,n])=>n[e]??null)])}}_make(t){let e=this.kinds.findIndex(a=>a.name===t),{title:n,unit:s}=this.kinds[e]??{title:t.replaceAll("_"," "),unit:""},r=e<0?5:e%Sy.length,o=[{label:n,unit:s,colour:Sy[r],dash:HA[r]}];return Wh(this.area,{title:n,x:{label:"time",unit:"s"},series:o,height:110})}};var My={person:["Click where the person starts","Click the goal of the person"],robot:["Click where the robot starts","Click the goal of the robot"],goal:["Click the goal"],move:["Click the new place"],you:["Click where you start; the run begins anew"]},ou=class{constructor(t,e){this.app=t,this.parts=e,this.names={navigators:[],robots:[]},this.tool=null,this.points=[];let n=(s,r)=>_("button",{type:"button","aria-pressed":"false","data-tool":s,onclick:()=>this.choose(this.tool===s?null:s)},r);this.buttons=[n("person","Add person"),n("robot","Add robot"),n("you","Be a person")],this.robot=_("select",{"aria-label":"Type of a new robot"}),this.exact=_("button",{type:"button",onclick:()=>this._dialog()},"Add at x, y\u2026"),this.element=_("div",{class:"tools",role:"group","aria-label":"Change the scene"},this.buttons,this.robot,this.exact)}know(t){this.names=t,It(this.robot,t.robots.map(e=>_("option",{},e))),t.robots.includes("turtlebot2")&&(this.robot.value="turtlebot2")}set live(t){this.element.hidden=!t,t||this.choose(null)}choose(t){this.tool=t,this.points=[];for(let e of this.buttons)e.setAttribute("aria-pressed",String(e.dataset.tool===t));this._hint()}async place({x:t,y:e}){let n={x:Number(t.toFixed(2)),y:Number(e.toFixed(2))},{tool:s}=this;if(this.points.push(n),this.points.length<My[s].length)return this._hint();let[r,o]=this.points;return this.choose(null),s==="goal"?this.parts.inspector.goal(n):s==="move"?this.parts.inspector.move(n):s==="you"?this._become(n):this._add(s,r,o)}_hint(){this.parts.picture.placing=this.tool!==null,this.parts.picture.say(this.tool?`${My[this.tool][this.points.length]} (Escape cancels)`:"")}_add(t,e,n){return ve(async()=>(t==="person"?await this.app.connection.call("simulator.order",{order:{order:"add-person",...e,goal_x:n.x,goal_y:n.y}}):await this.app.connection.call("simulator.add_robot",{type:this.robot.value,...e,goal_x:n.x,goal_y:n.y}),await this.parts.inspector.refresh(),!0))}async _become(t){let e=await ve(()=>this.app.connection.call("simulator.become_person",t));e&&this.parts.became(e)}_dialog(){let t=(r,o,a)=>({name:r,label:o,kind:"number",unit:"m",value:a}),e=[["person","Person"],["robot",`Robot (${this.robot.value})`],["you","Yourself"]],n=On([{name:"kind",label:"What",kind:"choice",value:"person",choices:e},t("x","x",0),t("y","y",0),t("goal_x","goal x",3),t("goal_y","goal y",0)]),s=async()=>{let{kind:r,x:o,y:a,goal_x:l,goal_y:c}=n.values();return r==="you"?this._become({x:o,y:a}):await this._add(r,{x:o,y:a},{x:l,y:c})===!0};De("Add",n.element,[["Cancel",()=>!0],["Add",s]])}};var au=[.1,.25,.5,1,2,5,10,null],Kf=i=>i===null?"no limit":`${i}x`,lu=class{constructor(t,e){this.app=t,this.status={state:"none"};let n=(r,o,a,l)=>_("button",{type:"button",title:l?`${o} (${l})`:o,onclick:a},r);this.run=n("Run","Run",()=>this.toggle(),"Space"),this.run.classList.add("main"),this.stepButton=n("Step","Step",()=>this.step(),"."),this.again=n("Restart","Restart",()=>e.restart(!1),"r"),this.seed=n("New seed","Restart with another seed",()=>e.restart(!0),"n"),this.save=n("Save","Save the recording",e.save),this.speed=_("select",{"aria-label":"Speed relative to real time",onchange:()=>this._chooseSpeed()},au.map(r=>_("option",{value:String(r)},Kf(r)))),this.scrubber=_("input",{type:"range","aria-label":"Time [s]",min:0,max:1,step:"any",hidden:!0,oninput:()=>this._seek()}),this.progress=_("progress",{"aria-label":"Simulated time",max:1,value:0}),this.ticks=_("div",{class:"event-ticks","aria-hidden":"true"}),this.clock=_("output",{class:"clock","aria-label":"Time"},"0.0 s"),this.line=_("p",{class:"status-line"});let s=_("div",{class:"track"},this.ticks,this.scrubber,this.progress);this.element=_("div",{class:"transport",role:"group","aria-label":"Run"},this.run,this.stepButton,s,this.clock,this.speed,this.again,this.seed,this.save),this._target=null,this._seeking=!1}toggle(){return this._call(this.status.state==="running"||this.status.state==="preparing"?"pause":"play")}step(t=1){return this._call("step",{count:t})}change(t){let e=au.findIndex(s=>s===this.status.speed),n=au[Math.min(au.length-1,Math.max(0,(e<0?3:e)+t))];return this.status.speed=n,this._call("speed",{speed:n})}jump(t){this.seek((this._target??this.status.time)+t)}async seek(t){if(this.status.kind==="episode"&&(this._target=Math.min(this.status.duration,Math.max(this.status.begin,t)),!this._seeking)){this._seeking=!0;try{for(;this._target!==null;){let e=this._target;await ve(()=>this.app.connection.call("simulator.seek",{time:e})),this._target===e&&(this._target=null)}}finally{this._seeking=!1}}}show(t){this.status=t;let e=t.kind==="episode",n=t.state==="running"||t.state==="preparing";this.run.textContent=n?"Pause":"Run";let s=["failed","none"].includes(t.state)||t.state==="ended"&&!e;this.run.disabled=this.stepButton.disabled=s;for(let o of[this.again,this.seed,this.save])o.hidden=e;this.scrubber.hidden=!e,this.progress.hidden=e;let r=t.time??0;e?(this.scrubber.min=t.begin,this.scrubber.max=t.duration,this._target===null&&document.activeElement!==this.scrubber&&(this.scrubber.value=r),this.scrubber.setAttribute("aria-valuetext",`${r.toFixed(1)} s`)):this.progress.value=t.duration?Math.min(1,r/t.duration):0,this.clock.textContent=`${r.toFixed(1)} / ${(t.duration??0).toFixed(0)} s`,document.activeElement!==this.speed&&(this.speed.value=String(t.speed))}mark(t){let{begin:e=0,duration:n=1}=this.status;It(this.ticks,t.slice(0,300).map(s=>{let r=_("i",{class:s.kind.replace(" ","-")});return r.style.left=`${100*(s.time-e)/Math.max(1e-9,n-e)}%`,r}))}_chooseSpeed(){this._call("speed",{speed:this.speed.value==="null"?null:Number(this.speed.value)})}_seek(){this.seek(Number(this.scrubber.value))}_call(t,e={}){return ve(()=>this.app.connection.call(`simulator.${t}`,e))}};var Jf=40,cu=class{constructor(t){this.app=t,this.live=!1,this.rows=[],this.search=_("input",{type:"search","aria-label":"Search values",placeholder:"robot/drive",oninput:()=>this._list()}),this.list=_("div",{class:"values"}),this.element=_("details",{ontoggle:()=>this.element.open&&this.load()},_("summary",{},"Values of the trial"),this.search,this.list)}async load(){this.rows=await this.app.connection.call("simulator.values").catch(()=>[]),this._list()}async open(t){this.element.open=!0,this.search.value=t,await this.load(),this.element.scrollIntoView({block:"nearest"})}_list(){let t=this.search.value.toLowerCase().split(/\s+/).filter(Boolean),e=this.rows.filter(({path:n,note:s})=>t.every(r=>n.includes(r)||s.toLowerCase().includes(r)));It(this.list,e.slice(0,Jf).map(n=>this._row(n)),e.length>Jf?_("p",{class:"faint"},`${e.length-Jf} more: type more letters`):null)}_row(t){let e=`${t.path}${t.unit?` [${t.unit}]`:""}`,n={"aria-label":e,disabled:!this.live,onchange:()=>this._change(t,r)},s=t.kind==="switch"?["true","false"]:t.choices,r=s?_("select",n,s.map(o=>_("option",{selected:o===t.text},o))):_("input",{...n,type:"text",inputmode:t.kind==="text"?"text":"decimal",value:t.text,size:8});return _("div",{class:"value",title:t.note},_("span",{},e),r,t.live?null:_("small",{},"at a restart"))}async _change(t,e){let n=e.value;await ve(async()=>(t.live?await this.app.connection.call("simulator.set_value",{path:t.path,text:n}):await this.app.connection.call("simulator.restart",{settings:{[t.path]:n}}),Te(`${t.path} = ${n}`),!0))?await this.load():e.value=t.text}};var VA=5e3,wy=2e3,jf=class{constructor(t,e){this.app=e,this.status={state:"none"},this.source={},this.latency=null,this.fps=0,this._make(),t.classList.add("simulator"),t.append(this.library.element,_("div",{class:"middle"},this.tools.element,this.picture.element,this.drive.element,this.transport.element,this.line,this.summary),this.side),this._listen(),this._keys(),setInterval(()=>this._measure(),wy),setInterval(()=>this._summarize(),VA)}show(){this.picture.shown=!0}hide(){this.picture.shown=!1}greet(t){this.plots.know(t.plots),this._opened(t.source,t.status),this.plots.begin(t.history),this._take(t.status),this.library.load().catch(e=>Te(e.message,"error")),this.app.connection.call("simulator.names").then(e=>{this.tools.know(e),this.inspector.navigators=e.navigators},()=>{}),t.status.state!=="none"&&this.app.connection.call("simulator.show_frame").catch(()=>{})}_make(){let{app:t}=this;this.library=new su(t),this.picture=new Ao(t,{select:e=>this.inspector.select(e),place:e=>this.tools.place(e),loaded:()=>this._loaded()}),this.transport=new lu(t,{restart:e=>this._restart(e),save:()=>this._save()}),this.values=new cu(t),this.drive=new eu(t,{started:e=>this._driving(e),stopped:()=>this.display.look("free")}),this.inspector=new iu(t,{chosen:e=>this.picture.mark(e?.kind??null,e?.id),tool:e=>this.tools.choose(e),drive:(e,n)=>this.drive.start(e,n),values:e=>this.values.open(e)}),this.tools=new ou(t,{inspector:this.inspector,picture:this.picture,became:e=>this._became(e)}),this.display=new tu(t,this.picture),this.plots=new ru(t),this.episode=new nu(t,{transport:this.transport,library:this.library,names:()=>this.tools.names}),this.line=_("p",{class:"status-line"}),this.summary=_("p",{class:"summary",role:"status","aria-label":"Summary of the picture"}),this.side=_("aside",{class:"side","aria-label":"Inspector, display and plots"},this.episode.element,this.inspector.element,this.display.element,this.plots.element,this.values.element)}_listen(){let{connection:t}=this.app;t.on("simulator.status",e=>this._take(e)),t.on("simulator.opened",({source:e,status:n})=>{this._opened(e,n),this.plots.begin([])}),t.draw("scene",e=>this.picture.take(e)),t.on("lost",()=>this.drive.subject&&this.drive.forget())}_opened(t,e){this.source=t,this.picture.newest=null,this.picture.preview(e.state==="preparing"?t.preview??null:null),this.library.mark(t.name);let n=t.kind==="run";this.tools.live=this.inspector.live=this.values.live=n,this.episode.element.hidden=n||!t.kind,this.transport.mark([]),this._readEpisode=!n,this._waiting||this.inspector.select(null),this.drive.subject&&this.drive.forget()}async _take(t){let e=this.status;this.status=t,this.transport.show(t),this.plots.take(t),this._showLine(),t.problems?.length&&t.problems.join()!==e.problems?.join()&&Te(t.problems.join(`
`),"error"),t.state==="preparing"?this.picture.say(t.compiling?"Compiling for the first run on this computer; meanwhile everybody walks straight":"Preparing the simulation"):(e.state==="preparing"||t.state==="failed")&&this.picture.say(""),t.state==="failed"&&this.picture.preview(null),t.state==="ended"&&e.state!=="ended"&&this.drive.subject&&this.drive.forget(),this._readEpisode&&t.kind==="episode"&&!["preparing","failed"].includes(t.state)&&(this._readEpisode=!1,await ve(()=>this._showEpisode())),this.inspector.element.open&&this.inspector.update()}async _showEpisode(){let{events:t,series:e}=await this.app.connection.call("simulator.episode");this.episode.show(t),this.transport.mark(t),this.plots.whole(e)}_loaded(){if(this.display.loaded(),this.inspector.refresh(),this._waiting){let t=this._waiting;this._waiting=null,this._walk(t)}}_driving({kind:t,name:e}){let n=this.picture.scene.state.description?.robots??[];t==="robot"&&this.inspector.select({kind:t,id:n.find(s=>s.name===e)?.id}),this.display.look("follow")}_became(t){this._waiting=t,this.status.trial&&this.picture.scene.state.frame&&this.status.state==="running"&&this.picture.wake()}async _walk(t){let n=(await this.app.connection.call("simulator.people")).find(s=>s.name===t);n&&await this.inspector.select({kind:"person",id:n.id}),await this.drive.start("avatar",t)}_restart(t){if(this.status.kind!=="run")return;let e=t?Math.floor(Math.random()*1e6):null;return ve(()=>this.app.connection.call("simulator.restart",{seed:e}))}async _save(){let t=await ve(()=>this.app.connection.call("simulator.save"));t&&(Te(`Saved as ${t}`),await this.library.loadEpisodes())}async _measure(){let t=this.picture.frames;if(this.fps=(t-(this._drawn??t))/(wy/1e3),this._drawn=t,!this.app.connection.open)return;let e=performance.now();await this.app.connection.call("simulator.ping").catch(()=>{}),this.latency=performance.now()-e,this._showLine()}_showLine(){let{state:t,trial:e,seed:n,time:s,factor:r,values:o,outcome:a,orders:l,speed:c,problems:u}=this.status;if(!e){this.line.textContent=u?.length?u[0]:"Nothing is open";return}let d=t==="ended"&&a?`ended: ${a}`:t,h=[`${e}, seed ${n}: ${d}`,`${(s??0).toFixed(1)} s`,`speed ${Kf(c)}`];t==="running"&&r&&h.push(`real-time factor ${r.toFixed(2)}`),o?.people!==void 0&&h.push(`${o.people} people`),h.push(`${l} orders`,`${this.fps.toFixed(0)} pictures/s`),this.latency!==null&&h.push(`latency ${this.latency.toFixed(0)} ms`),this.line.textContent=h.join("  \xB7  ")}_summarize(){let{state:t,values:e,time:n}=this.status;if(!e||t!=="running"||e.people===void 0||this.picture.element.offsetParent===null)return;let s=e.clearance===null||e.clearance===void 0?"":`; the nearest person is ${e.clearance.toFixed(1)} m from the robot`;this.summary.textContent=`At ${n.toFixed(0)} s: ${e.people} people${s}.`}_keys(){let{transport:t}=this,e=()=>this.status.kind==="episode",n=s=>()=>!this.drive.subject&&(e()?t.jump(s):s>0&&t.step());this.app.keys.add("simulator",[[" ","Run or pause",()=>t.toggle()],[".","One step",()=>t.step()],["ArrowRight","One step; in an episode: 1 s ahead",n(1)],["ArrowLeft","In an episode: 1 s back",n(-1)],["[","Slower",()=>t.change(-1)],["]","Faster",()=>t.change(1)],["r","Restart",()=>this._restart(!1)],["n","Restart with another seed",()=>this._restart(!0)],["j","Event before",()=>this.episode.jump(-1)],["k","Event after",()=>this.episode.jump(1)],["+","Add a person by two clicks",()=>this.tools.choose("person")],["g","Goal of the chosen one by a click",()=>this.inspector.state&&this.tools.choose("goal")],["Delete","Remove the chosen one",()=>this.inspector.remove()],["f","Follow",()=>this.display.look("follow")],["o","Overview",()=>this.display.reset()],["v","In space or from above",()=>this._turnView()],["Escape","Cancel; give a robot back",()=>this.tools.choose(null)]])}_turnView(){this.display.view.value=this.picture.view==="3d"?"2d":"3d",this.picture.setView(this.display.view.value)}},Ey={name:"simulator",title:"Simulator",mount:(i,t)=>new jf(i,t)};var Ty=[Ey,yy,kp,zp,S0];window.crowdbot=new ul(document.getElementById("app"),Ty);
