// SPDX-License-Identifier: Apache-2.0
// slice of a reed valve: one cell across y
DefineConstant[ f = 1, w = 0.01, gap = 0.3, ng = 3 ];
mm = 1e-3; th = 0.4;
x() = {0, 15*mm, 50*mm, 60*mm, 110*mm};
z() = {-60*mm, 0, gap*mm, (gap+th)*mm, 20*mm};
nx() = {Round(10*f), Round(20*f), Round(10*f), Round(24*f)};
nz() = {Round(24*f), Round(ng), 1, Round(18*f)};
For j In {0:4}
  For i In {0:4}
    Point(1+i+5*j) = {x(i), 0, z(j)};
  EndFor
EndFor
For j In {0:4}
  For i In {0:4}
    p = 1+i+5*j;
    If (i < 4)
      Line(100+p) = {p, p+1};
      If (i == 3)
        Transfinite Curve {100+p} = nx(i)+1 Using Progression 1.06;
      ElseIf (i == 2)
        Transfinite Curve {100+p} = nx(i)+1;
      Else
        Transfinite Curve {100+p} = nx(i)+1;
      EndIf
    EndIf
    If (j < 4)
      Line(200+p) = {p, p+5};
      If (j == 0)
        Transfinite Curve {200+p} = nz(j)+1 Using Progression 1/1.12;
      ElseIf (j == 3)
        Transfinite Curve {200+p} = nz(j)+1 Using Progression 1.15;
      Else
        Transfinite Curve {200+p} = nz(j)+1;
      EndIf
    EndIf
  EndFor
EndFor
surf() = {};
For j In {0:3}
  For i In {0:3}
    p = 1+i+5*j;
    fluid = 0;
    If (j == 0 && i == 1) fluid = 1; EndIf
    If (j == 1 || j == 3) fluid = 1; EndIf
    If (j == 2 && i == 3) fluid = 1; EndIf
    If (fluid)
      Curve Loop(p) = {100+p, 200+p+1, -(100+p+5), -(200+p)};
      Plane Surface(p) = {p}; Transfinite Surface {p}; Recombine Surface {p};
      surf() += {p};
    EndIf
  EndFor
EndFor
vol() = {}; inlet() = {}; outlet() = {}; plate() = {}; seat() = {}; walls() = {}; sides() = {};
For s In {0:#surf()-1}
  p = surf(s); i = (p-1) % 5; j = Floor((p-1)/5);
  out() = Extrude {0, w, 0} { Surface{p}; Layers{1}; Recombine; };
  vol() += {out(1)}; sides() += {p, out(0)};
  // out(2): bottom, out(3): right, out(4): top, out(5): left
  If (j == 0) inlet() += {out(2)}; walls() += {out(3), out(5)}; EndIf
  If (j == 1)
    If (i != 1 && i < 3) seat() += {out(2)}; EndIf
    If (i == 3) walls() += {out(2)}; outlet() += {out(3)}; EndIf
    If (i == 0) walls() += {out(5)}; EndIf
    If (i < 3) plate() += {out(4)}; EndIf
  EndIf
  If (j == 2) plate() += {out(5)}; outlet() += {out(3)}; EndIf
  If (j == 3)
    walls() += {out(4)};
    If (i < 3) plate() += {out(2)}; EndIf
    If (i == 0) walls() += {out(5)}; EndIf
    If (i == 3) outlet() += {out(3)}; EndIf
  EndIf
EndFor
Physical Surface("inlet") = {inlet()};
Physical Surface("outlet") = {outlet()};
Physical Surface("walls") = {walls()};
Physical Surface("seat") = {seat()};
Physical Surface("plate") = {plate()};
Physical Surface("sides") = {sides()};
Physical Volume("fluid") = {vol()};
