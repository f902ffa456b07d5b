// SPDX-License-Identifier: Apache-2.0
// Channel 2.2 x 0.41 m with a cylinder of diameter 0.1 m at (0.2, 0.2): rings of quadrilaterals around the cylinder
// inside a square, rows and columns elsewhere. What counts are the cells around the cylinder, where the layers leave it.
DefineConstant[ n = 68 ];            // cells on a quarter of the cylinder
n_ring = Round(0.6 * n);             // from the cylinder to the square
n_left = Round(0.45 * n);
DefineConstant[ wake = 2.6 ];        // cells along the wake over n, each longer than the one before by this factor
DefineConstant[ growth_wake = 1.013 ];
DefineConstant[ side = 0.5 ];        // between the square and the walls of the channel, over n
n_wake = Round(wake * n);
n_side = Round(side * n);
growth_ring = 5 ^ (1 / n_ring);      // the last cell of a ring is about 5 times the first

r = 0.05; c = 0.2; s = 0.085; q = r / Sqrt(2);
x() = {0, c - s, c + s, 2.2};
y() = {0, c - s, c + s, 0.41};
For j In {0 : 3}
  For i In {0 : 3}
    Point(4 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
Point(17) = {c - q, c - q, 0}; // the same order as the corners of the square: 6, 7, 11, 10
Point(18) = {c + q, c - q, 0};
Point(19) = {c + q, c + q, 0};
Point(20) = {c - q, c + q, 0};
Point(21) = {c, c, 0};

For j In {0 : 3}
  For i In {0 : 2}
    Line(100 + 3 * j + i) = {4 * j + i + 1, 4 * j + i + 2};
  EndFor
  Transfinite Curve {100 + 3 * j} = n_left + 1 Using Progression 1 / 1.01;
  Transfinite Curve {101 + 3 * j} = n + 1;
  Transfinite Curve {102 + 3 * j} = n_wake + 1 Using Progression growth_wake;
EndFor
For j In {0 : 2}
  For i In {0 : 3}
    Line(200 + 4 * j + i) = {4 * j + i + 1, 4 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {200 : 203} = n_side + 1 Using Bump 0.4;
Transfinite Curve {204 : 207} = n + 1;
Transfinite Curve {208 : 211} = n_side + 1 Using Bump 0.4;

corner() = {6, 7, 11, 10};
edge() = {104, 206, -107, -205}; // of the square, counter-clockwise
For k In {0 : 3}
  Circle(300 + k) = {17 + k, 21, 17 + (k + 1) % 4};
  Transfinite Curve {300 + k} = n + 1;
  Line(310 + k) = {17 + k, corner(k)};
  Transfinite Curve {310 + k} = n_ring + 1 Using Progression growth_ring;
EndFor
For k In {0 : 3}
  Curve Loop(400 + k) = {300 + k, 310 + (k + 1) % 4, -edge(k), -(310 + k)};
  Plane Surface(400 + k) = {400 + k};
  Transfinite Surface {400 + k};
EndFor
For j In {0 : 2}
  For i In {0 : 2}
    If (!(i == 1 && j == 1))
      l = 500 + 3 * j + i;
      Curve Loop(l) = {100 + 3 * j + i, 200 + 4 * j + i + 1, -(100 + 3 * (j + 1) + i), -(200 + 4 * j + i)};
      Plane Surface(l) = {l};
      Transfinite Surface {l};
    EndIf
  EndFor
EndFor
surfaces() = Surface "*";
Recombine Surface {surfaces()};
Physical Curve("inlet") = {200, 204, 208};
Physical Curve("outlet") = {203, 207, 211};
Physical Curve("walls") = {100 : 102, 109 : 111};
Physical Curve("cylinder") = {300 : 303};
Physical Surface("fluid") = {surfaces()};
