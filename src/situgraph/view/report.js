// Click a picture to enlarge it; wheel to zoom, drag to move, double click to see all again.
(function(){
var box=document.createElement('dialog'),shut=document.createElement('button'),view,start;
shut.textContent='Close';shut.onclick=function(){box.close()};
document.body.appendChild(box);
function show(picture){
  var copy=picture.cloneNode(true);
  box.replaceChildren(copy,shut);box.showModal();
  if(!copy.viewBox)return;
  var b=copy.viewBox.baseVal,full=[b.x,b.y,b.width,b.height];view=full.slice();
  function set(){copy.setAttribute('viewBox',view.join(' '))}
  function perPixel(){var r=copy.getBoundingClientRect();return Math.max(view[2]/r.width,view[3]/r.height)}
  copy.addEventListener('wheel',function(e){
    e.preventDefault();
    var f=Math.exp(e.deltaY*0.0015),p=copy.createSVGPoint();p.x=e.clientX;p.y=e.clientY;
    var m=p.matrixTransform(copy.getScreenCTM().inverse());
    f=Math.min(Math.max(f,full[2]/60/view[2]),full[2]*1.2/view[2]);
    view=[m.x+(view[0]-m.x)*f,m.y+(view[1]-m.y)*f,view[2]*f,view[3]*f];set();
  },{passive:false});
  copy.addEventListener('pointerdown',function(e){start=[e.clientX,e.clientY,view[0],view[1]];
    copy.setPointerCapture(e.pointerId)});
  copy.addEventListener('pointermove',function(e){if(!start)return;var s=perPixel();
    view[0]=start[2]-(e.clientX-start[0])*s;view[1]=start[3]-(e.clientY-start[1])*s;set()});
  copy.addEventListener('pointerup',function(){start=null});
  copy.addEventListener('dblclick',function(){view=full.slice();set()});
}
document.querySelectorAll('figure>svg,figure>img').forEach(function(p){
  p.addEventListener('click',function(){show(p)})});
addEventListener('beforeprint',function(){
  document.querySelectorAll('details').forEach(function(d){d.open=true})});
})();
