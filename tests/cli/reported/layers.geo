// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 6, nx = 12, shape = 1 ];
L = 0.6; h = 0.06;
Point(1)={0,0,0}; Point(2)={L,0,0}; Point(3)={L,h,0}; Point(4)={L,2*h,0}; Point(5)={0,2*h,0}; Point(6)={0,h,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,5}; Line(5)={5,6}; Line(6)={6,1}; Line(7)={6,3};
Curve Loop(1)={1,2,-7,6}; Plane Surface(1)={1}; Curve Loop(2)={7,3,4,5}; Plane Surface(2)={2};
Transfinite Curve{1,7,4}=nx+1; Transfinite Curve{2,3,5,6}=n+1; Transfinite Surface{1}; Transfinite Surface{2};
If (shape==1)
Recombine Surface{1,2};
EndIf
Physical Curve("left")={5,6}; Physical Curve("right")={2,3}; Physical Curve("low")={1}; Physical Curve("top")={4};
Physical Surface("brass")={1}; Physical Surface("steel")={2};
