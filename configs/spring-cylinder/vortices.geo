// SPDX-License-Identifier: Apache-2.0
// A cylinder of diameter 1 in a stream: rings of quadrilaterals around it inside a square, rows and columns elsewhere.
DefineConstant[ n = 16 ];            // cells on a quarter of the cylinder
n_ring = Round(1.5 * n);             // from the cylinder to the square
n_left = n;
n_wake = 4 * n;
n_side = n;                          // between the square and the sides
growth_ring = 8 ^ (1 / n_ring);      // the last cell of a ring is about 8 times the first

r = 0.5; s = 2; q = r / Sqrt(2);
x() = {-10, -s, s, 25};
y() = {-10, -s, s, 10};
For j In {0 : 3}
  For i In {0 : 3}
    Point(4 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
Point(17) = {-q, -q, 0}; // the same order as the corners of the square: 6, 7, 11, 10
Point(18) = {q, -q, 0};
Point(19) = {q, q, 0};
Point(20) = {-q, q, 0};
Point(21) = {0, 0, 0};

For j In {0 : 3}
  For i In {0 : 2}
    Line(100 + 3 * j + i) = {4 * j + i + 1, 4 * j + i + 2};
  EndFor
  Transfinite Curve {100 + 3 * j} = n_left + 1 Using Progression 1 / 1.09;
  Transfinite Curve {101 + 3 * j} = n + 1;
  Transfinite Curve {102 + 3 * j} = n_wake + 1 Using Progression 1.012;
EndFor
For j In {0 : 2}
  For i In {0 : 3}
    Line(200 + 4 * j + i) = {4 * j + i + 1, 4 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {200 : 203} = n_side + 1 Using Progression 1 / 1.09;
Transfinite Curve {204 : 207} = n + 1;
Transfinite Curve {208 : 211} = n_side + 1 Using Progression 1.09;

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
Physical Curve("sides") = {100 : 102, 109 : 111};
Physical Curve("cylinder") = {300 : 303};
Physical Surface("fluid") = {surfaces()};
