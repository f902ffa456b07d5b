// SPDX-License-Identifier: Apache-2.0
DefineConstant[ w = 0.01, f = 1 ];
mm = 1e-3;
Point(1) = {0,0,0}; Point(2) = {60*mm,0,0}; Point(3) = {60*mm,w,0}; Point(4) = {0,w,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Transfinite Curve{1,3} = Round(60*f)+1; Transfinite Curve{2,4} = 5;
Curve Loop(1)={1:4}; Plane Surface(1)={1}; Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("root")={4}; Physical Curve("tip")={2}; Physical Curve("sides")={1,3};
Physical Surface("plate")={1};
