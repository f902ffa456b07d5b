// SPDX-License-Identifier: Apache-2.0
// A horizontal beam of 1 m by 0.1 m at the left wall of a tank of 2 m by 2 m (solid = 1), or the fluid around it; with d > 0 extruded by it.
DefineConstant[ solid = 0, d = 0, n = 1 ];
Point(5) = {0, 1.05, 0}; Point(6) = {1, 1.05, 0}; Point(7) = {1, 0.95, 0}; Point(8) = {0, 0.95, 0};
Line(9) = {5, 6}; Line(10) = {6, 7}; Line(11) = {7, 8};
If (solid)
  Line(12) = {8, 5};
  Curve Loop(1) = {9:12}; Plane Surface(1) = {1};
  Transfinite Curve {9, 11} = 20*n + 1; Transfinite Curve {10, 12} = 2*n + 1; Transfinite Surface {1}; Recombine Surface {1};
Else
  Point(1) = {0, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {2, 2, 0}; Point(4) = {0, 2, 0};
  Point(9) = {1, 0, 0}; Point(10) = {1, 2, 0}; Point(11) = {2, 0.95, 0}; Point(12) = {2, 1.05, 0};
  Line(1) = {1, 9}; Line(2) = {9, 2}; Line(3) = {2, 11}; Line(4) = {11, 12}; Line(5) = {12, 3}; Line(6) = {3, 10}; Line(7) = {10, 4}; Line(8) = {4, 5};
  Line(12) = {8, 1}; Line(13) = {9, 7}; Line(14) = {7, 11}; Line(15) = {6, 12}; Line(16) = {6, 10};
  Curve Loop(1) = {1, 13, 11, 12}; Curve Loop(2) = {2, 3, -14, -13}; Curve Loop(3) = {14, 4, -15, 10}; Curve Loop(4) = {15, 5, 6, -16}; Curve Loop(5) = {9, 16, 7, 8};
  Plane Surface(1) = {1}; Plane Surface(2) = {2}; Plane Surface(3) = {3}; Plane Surface(4) = {4}; Plane Surface(5) = {5};
  Transfinite Curve {1, 11, 9, 7} = 10*n + 1; Transfinite Curve {2, 14, 15, 6} = 4*n + 1; Transfinite Curve {12, 13, 3, 8, 16, 5} = 5*n + 1;
  Transfinite Curve {4, 10} = 2*n + 1; Transfinite Surface {1:5}; Recombine Surface {1:5};
EndIf
If (d > 0)
  If (solid)
    out() = Extrude {0, 0, d} { Surface{1}; Layers{2}; Recombine; };
    Physical Surface("wet") = {out(2), out(3), out(4)}; Physical Surface("root") = {out(5)}; Physical Surface("sides") = {1, out(0)}; Physical Volume("body") = {out(1)};
  Else
    a() = Extrude {0, 0, d} { Surface{1:5}; Layers{2}; Recombine; };
    Physical Volume("body") = {1:5};
    Physical Surface("sides") = {1:5, a(0), a(6), a(12), a(18), a(24)};
    Physical Surface("walls") = {a(2), a(5), a(8), a(9), a(15), a(21), a(29)};
    Physical Surface("top") = {a(22), a(28)};
    Physical Surface("wet") = {a(4), a(17), a(26)};
  EndIf
Else
  Physical Surface("body") = {1:(solid ? 1 : 5)};
  Physical Curve("wet") = {9, 10, 11};
  If (solid)
    Physical Curve("root") = {12};
  Else
    Physical Curve("walls") = {1, 2, 3, 4, 5, 8, 12}; Physical Curve("top") = {6, 7};
  EndIf
EndIf
