// Stand-ins for the few types of Unity that the component uses, so that it can be compiled without the engine.
using System;
using System.Collections;

namespace UnityEngine
{
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class TooltipAttribute : Attribute { public TooltipAttribute(string text) { } }
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class RangeAttribute : Attribute { public RangeAttribute(float from, float to) { } }

    public class Object
    {
        public string name { get; set; }
        public static T Instantiate<T>(T original) where T : Object { return original; }
        public static bool operator ==(Object a, Object b) { return ReferenceEquals(a, b); }
        public static bool operator !=(Object a, Object b) { return !ReferenceEquals(a, b); }
        public override bool Equals(object other) { return ReferenceEquals(this, other); }
        public override int GetHashCode() { return 0; }
    }
    public sealed class TextAsset : Object { public byte[] bytes { get { return null; } } }
    public class Component : Object
    {
        public Transform transform { get { return null; } }
        public T GetComponent<T>() where T : class { return null; }
    }
    public class MonoBehaviour : Component { }
    public sealed class Transform : Component, IEnumerable
    {
        public Vector3 position { get; set; }
        public Quaternion rotation { get; set; }
        public IEnumerator GetEnumerator() { return null; }
    }
    public sealed class MeshFilter : Component { public Mesh mesh { get; set; } }
    public sealed class SkinnedMeshRenderer : Component { public Mesh sharedMesh { get; set; } }
    public sealed class Mesh : Object
    {
        public int vertexCount { get { return 0; } }
        public Vector3[] vertices { get; set; }
        public Vector3[] normals { get; set; }
        public void MarkDynamic() { }
        public void RecalculateBounds() { }
    }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
    }
    public enum Space { World, Self }
    public struct Quaternion { }
    public struct Matrix4x4
    {
        public float this[int row, int column] { get { return 0; } }
        public static Matrix4x4 TRS(Vector3 position, Quaternion rotation, Vector3 scale) { return new Matrix4x4(); }
    }
    public static class Time { public static float deltaTime { get { return 0; } } }
    public static class Debug
    {
        public static void LogWarning(object message, Object context) { }
        public static void LogError(object message, Object context) { }
    }
}
