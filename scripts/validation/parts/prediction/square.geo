// SPDX-License-Identifier: Apache-2.0
// Channel 2.2 x 0.41 m with a square of 0.1 m about (0.2, 0.2); n cells on each of its sides, finer towards its corners.
DefineConstant[ n = 8 ];
g = 1 + 1.2 / n;                     // of neighbouring cells away from the square; behind it over 4 n cells
g_wake = 1 + 0.84 / n;
x() = {0, 0.15, 0.25, 2.2};
y() = {0, 0.15, 0.25, 0.41};
For j In {0 : 3}
  For i In {0 : 3}
    Point(4 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 2}
    Line(100 + 3 * j + i) = {4 * j + i + 1, 4 * j + i + 2};
  EndFor
  Transfinite Curve {100 + 3 * j} = n + 1 Using Progression 1 / g;
  Transfinite Curve {101 + 3 * j} = n + 1 Using Bump 0.4;
  Transfinite Curve {102 + 3 * j} = 4 * n + 1 Using Progression g_wake;
EndFor
For j In {0 : 2}
  For i In {0 : 3}
    Line(200 + 4 * j + i) = {4 * j + i + 1, 4 * (j + 1) + i + 1};
  EndFor
EndFor
Transfinite Curve {200 : 203} = n + 1 Using Progression 1 / g;
Transfinite Curve {204 : 207} = n + 1 Using Bump 0.4;
Transfinite Curve {208 : 211} = n + 1 Using Progression g;
surfaces() = {};
For j In {0 : 2}
  For i In {0 : 2}
    If (!(i == 1 && j == 1))
      l = 500 + 3 * j + i;
      Curve Loop(l) = {100 + 3 * j + i, 200 + 4 * j + i + 1, -(100 + 3 * (j + 1) + i), -(200 + 4 * j + i)};
      Plane Surface(l) = {l};
      Transfinite Surface {l};
      surfaces() += {l};
    EndIf
  EndFor
EndFor
Recombine Surface {surfaces()};
Physical Curve("inlet") = {200, 204, 208};
Physical Curve("outlet") = {203, 207, 211};
Physical Curve("walls") = {100 : 102, 109 : 111};
Physical Curve("square") = {104, 107, 205, 206};
Physical Surface("fluid") = {surfaces()};
