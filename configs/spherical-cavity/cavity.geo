// SPDX-License-Identifier: Apache-2.0
// Eighth of a ball of radius 10 m with a cavity of radius 1 m: three blocks of hexahedra that meet on the line x = y = z, finer towards the cavity.
DefineConstant [
  n = 8,       // cells along each half of an arc
  nr = 24,     // cells from the cavity to the outside
  growth = 40, // length of the last cell over that of the first
  shape = 0    // 0 hexahedra, 1 tetrahedra
];
progression = growth ^ (1 / (nr - 1));
h = Sqrt(1 / 2); t = Sqrt(1 / 3);
Point(100) = {0, 0, 0};
For k In {0 : 1}
  r = k == 0 ? 1 : 10; b = 10 * k;
  Point(b + 1) = {r, 0, 0};
  Point(b + 2) = {0, r, 0};
  Point(b + 3) = {0, 0, r};
  Point(b + 4) = {r * h, r * h, 0};
  Point(b + 5) = {0, r * h, r * h};
  Point(b + 6) = {r * h, 0, r * h};
  Point(b + 7) = {r * t, r * t, r * t};
  Circle(b + 1) = {b + 1, 100, b + 4};
  Circle(b + 2) = {b + 4, 100, b + 2};
  Circle(b + 3) = {b + 2, 100, b + 5};
  Circle(b + 4) = {b + 5, 100, b + 3};
  Circle(b + 5) = {b + 3, 100, b + 6};
  Circle(b + 6) = {b + 6, 100, b + 1};
  Circle(b + 7) = {b + 4, 100, b + 7};
  Circle(b + 8) = {b + 5, 100, b + 7};
  Circle(b + 9) = {b + 6, 100, b + 7};
  Transfinite Curve {b + 1 : b + 9} = n + 1;
  Curve Loop(b + 1) = {b + 1, b + 7, -(b + 9), b + 6};
  Curve Loop(b + 2) = {b + 2, b + 3, b + 8, -(b + 7)};
  Curve Loop(b + 3) = {b + 4, b + 5, b + 9, -(b + 8)};
  For i In {1 : 3}
    Surface(b + i) = {b + i} In Sphere {100};
  EndFor
EndFor
For i In {1 : 7}
  Line(20 + i) = {i, 10 + i};
EndFor
Transfinite Curve {21 : 27} = nr + 1 Using Progression progression;
// Between the two spheres over the arcs 1 to 9: from point a to point b.
a() = {1, 4, 2, 5, 3, 6, 4, 5, 6};
b() = {4, 2, 5, 3, 6, 1, 7, 7, 7};
For i In {1 : 9}
  Curve Loop(30 + i) = {i, 20 + b(i - 1), -(10 + i), -(20 + a(i - 1))};
  Plane Surface(30 + i) = {30 + i};
EndFor
Surface Loop(1) = {1, 11, 31, 37, 39, 36};
Surface Loop(2) = {2, 12, 32, 33, 38, 37};
Surface Loop(3) = {3, 13, 34, 35, 39, 38};
For i In {1 : 3}
  Volume(i) = {i};
EndFor
Transfinite Surface {1 : 3, 11 : 13, 31 : 39};
If (shape == 0)
  Recombine Surface {1 : 3, 11 : 13, 31 : 39};
EndIf
Transfinite Volume {1 : 3};
Physical Surface("cavity") = {1 : 3};
Physical Surface("outside") = {11 : 13};
Physical Surface("symmetry-z") = {31, 32};
Physical Surface("symmetry-x") = {33, 34};
Physical Surface("symmetry-y") = {35, 36};
Physical Volume("body") = {1 : 3};
