// SPDX-License-Identifier: Apache-2.0
DefineConstant [ n = 4, m = 4, lx = 1, ly = 1, s = 0.5, tri = 0 ];
Point(1) = {0, 0, 0}; Point(2) = {lx, 0, 0}; Point(3) = {lx, ly, 0}; Point(4) = {0, ly, 0}; Point(5) = {s * lx, ly, 0}; Point(6) = {s * lx, 0, 0};
Line(1) = {1, 6}; Line(2) = {6, 2}; Line(3) = {2, 3}; Line(4) = {3, 5}; Line(5) = {5, 4}; Line(6) = {4, 1}; Line(7) = {6, 5};
nl = Round(s * n);
Transfinite Curve {1, 5} = nl + 1; Transfinite Curve {2, 4} = n - nl + 1; Transfinite Curve {3, 6, 7} = m + 1;
Curve Loop(1) = {1, 7, 5, 6}; Curve Loop(2) = {2, 3, 4, -7};
Plane Surface(1) = {1}; Plane Surface(2) = {2}; Transfinite Surface {1, 2};
If (tri == 0)
  Recombine Surface {1, 2};
EndIf
Physical Curve("bottom") = {1, 2}; Physical Curve("right") = {3}; Physical Curve("pressed") = {5}; Physical Curve("top") = {4}; Physical Curve("left") = {6};
Physical Surface("one") = {1}; Physical Surface("two") = {2};
