// SPDX-License-Identifier: Apache-2.0
// A quarter of a square block, half its width and half its height, n cells along each; with depth > 0 an eighth of one that is 2 depth deep.
// bend: angle [degrees] from the upright at which its side meets the platen; the side is an arc, upright at mid-height. 0: straight.
DefineConstant [ n = 16, depth = 0, bend = 0 ];
b = 0.5;
Point(1) = {0, 0, 0}; Point(2) = {b, 0, 0}; Point(4) = {0, b, 0};
Line(1) = {1, 2}; Line(4) = {4, 1};
If (bend > 0)
  a = bend * Pi / 180; r = b / Sin(a);
  Point(3) = {b + r * (1 - Cos(a)), b, 0}; Point(5) = {b + r, 0, 0};
  Circle(2) = {2, 5, 3};
Else
  Point(3) = {b, b, 0}; Line(2) = {2, 3};
EndIf
Line(3) = {3, 4};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1; Transfinite Surface{1}; Recombine Surface{1};
If (depth > 0)
  e[] = Extrude {0, 0, depth} { Surface{1}; Layers{n}; Recombine; };
  Physical Volume("block") = {e[1]};
  Physical Surface("back") = {1}; Physical Surface("front") = {e[0]};
  Physical Surface("bottom") = {e[2]}; Physical Surface("right") = {e[3]};
  Physical Surface("top") = {e[4]}; Physical Surface("left") = {e[5]};
Else
  Physical Surface("block") = {1};
  Physical Curve("bottom") = {1}; Physical Curve("right") = {2};
  Physical Curve("top") = {3}; Physical Curve("left") = {4};
EndIf
