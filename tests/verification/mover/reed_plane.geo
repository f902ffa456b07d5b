// SPDX-License-Identifier: Apache-2.0
// Slice of a reed valve in two dimensions: a plate 60 x 0.4 mm over its seat and slot, in a chamber (case reed-slice of the reference data).
DefineConstant[ f = 1, gap = 0.3, ng = 3 ];
mm = 1e-3; th = 0.4;
x() = {0, 15*mm, 50*mm, 60*mm, 110*mm};
z() = {-60*mm, 0, gap*mm, (gap+th)*mm, 20*mm};
nx() = {Round(10*f), Round(20*f), Round(10*f), Round(26*f)};
nz() = {Round(24*f), Round(ng), 1, Round(11*f)};
For j In {0:4}
  For i In {0:4}
    Point(1+i+5*j) = {x(i), z(j), 0};
  EndFor
EndFor
For j In {0:4}
  For i In {0:4}
    p = 1+i+5*j;
    If (i < 4)
      Line(100+p) = {p, p+1};
      If (i == 3)
        Transfinite Curve {100+p} = nx(i)+1 Using Progression 1.09;
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
        Transfinite Curve {200+p} = nz(j)+1 Using Progression 1.12;
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
inlet() = {}; outlet() = {}; plate() = {}; seat() = {}; walls() = {};
For s In {0:#surf()-1}
  p = surf(s); i = (p-1) % 5; j = Floor((p-1)/5);
  bottom = 100+p; right = 201+p; top = 105+p; left = 200+p;
  If (j == 0) inlet() += {bottom}; walls() += {right, left}; EndIf
  If (j == 1)
    If (i != 1 && i < 3) seat() += {bottom}; EndIf
    If (i == 3) walls() += {bottom}; outlet() += {right}; EndIf
    If (i == 0) walls() += {left}; EndIf
    If (i < 3) plate() += {top}; EndIf
  EndIf
  If (j == 2) plate() += {left}; outlet() += {right}; EndIf
  If (j == 3)
    walls() += {top};
    If (i < 3) plate() += {bottom}; EndIf
    If (i == 0) walls() += {left}; EndIf
    If (i == 3) outlet() += {right}; EndIf
  EndIf
EndFor
Physical Curve("inlet") = {inlet()};
Physical Curve("outlet") = {outlet()};
Physical Curve("walls") = {walls()};
Physical Curve("seat") = {seat()};
Physical Curve("plate") = {plate()};
Physical Surface("fluid") = {surf()};
