// SPDX-License-Identifier: Apache-2.0
// Two arms joined on the left, a slot of 1 mm between them.
DefineConstant[ n = 2 ];
L = 0.2; h = 0.02; g = 0.001;
x() = {0, 0.02, L}; y() = {0, h, h + g, 2 * h + g};
For i In {0 : 2}
  For j In {0 : 3}
    Point(10 * j + i + 1) = {x(i), y(j), 0};
  EndFor
EndFor
For j In {0 : 3}
  For i In {0 : 1}
    Line(100 + 10 * j + i) = {10 * j + i + 1, 10 * j + i + 2}; Transfinite Curve {100 + 10 * j + i} = (i == 0 ? 2 * n : 18 * n) / 1 + 1;
  EndFor
EndFor
For j In {0 : 2}
  For i In {0 : 2}
    If (j != 1 || i < 2)
      Line(200 + 10 * j + i) = {10 * j + i + 1, 10 * (j + 1) + i + 1}; Transfinite Curve {200 + 10 * j + i} = (j == 1 ? 1 : 2 * n) + 1;
    EndIf
  EndFor
EndFor
s() = {};
For j In {0 : 2}
  For i In {0 : 1}
    If (j != 1 || i == 0)
      k = 300 + 10 * j + i; Curve Loop(k) = {100 + 10 * j + i, 200 + 10 * j + i + 1, -(100 + 10 * (j + 1) + i), -(200 + 10 * j + i)};
      Plane Surface(k) = {k}; Transfinite Surface {k}; Recombine Surface {k}; s() += {k};
    EndIf
  EndFor
EndFor
Physical Curve("root") = {200, 210, 220}; Physical Curve("above") = {131}; Physical Curve("below") = {101}; Physical Curve("slot") = {111, 121, 211};
Physical Curve("rest") = {100, 130, 202, 222}; Physical Surface("clip") = s();
