// A face on the meshes of an imported head. See README.md.
using System;
using System.Collections.Generic;
using UnityEngine;

namespace Fascia.Unity
{
    public sealed class FaceBehaviour : MonoBehaviour
    {
        public TextAsset rig;
        [Tooltip("-1 the finest")] public int level = -1;
        [Tooltip("One for each mesh of the rig; found by name when empty")] public Transform[] parts;
        [Range(0, 1)] public float inertia = 1;

        public Asset Asset { get; private set; }
        public Face Face { get; private set; }

        sealed class Part
        {
            public int index;
            public UnityEngine.Mesh mesh;
            public float[] numbers;
            public Vector3[] positions, normals;
        }
        readonly List<Part> bound = new List<Part>();
        readonly float[] place = new float[16];

        void Awake()
        {
            Asset = Asset.Load(rig.bytes);
            Face = new Face(Asset, Space.Mesh, level);
            for (int i = 0; i < Asset.Meshes.Length; ++i) Bind(i);
        }

        void Bind(int index)
        {
            Fascia.Mesh wanted = Asset.Meshes[index];
            Transform part = parts != null && index < parts.Length && parts[index] != null ? parts[index] : Find(transform, wanted.Name);
            UnityEngine.Mesh mesh = MeshOf(part);
            if (mesh == null)
            {
                Debug.LogWarning("Fascia: no mesh for " + wanted.Name + " (" + wanted.Part + ")", this);
                return;
            }
            if (mesh.vertexCount != wanted.VertexCount)
            {
                Debug.LogError("Fascia: " + wanted.Name + " was imported with " + mesh.vertexCount + " vertices where the rig has " +
                               wanted.VertexCount + ": import it without welding, splitting or optimising", this);
                return;
            }
            mesh.MarkDynamic();
            bound.Add(new Part { index = index, mesh = mesh, numbers = new float[3 * wanted.VertexCount],
                                 positions = new Vector3[wanted.VertexCount], normals = new Vector3[wanted.VertexCount] });
        }

        static Transform Find(Transform root, string name)
        {
            if (root.name == name) return root;
            foreach (Transform child in root)
            {
                Transform found = Find(child, name);
                if (found != null) return found;
            }
            return null;
        }

        static UnityEngine.Mesh MeshOf(Transform part)
        {
            if (part == null) return null;
            var filter = part.GetComponent<MeshFilter>();
            if (filter != null) return filter.mesh;  // an instance of its own
            var skinned = part.GetComponent<SkinnedMeshRenderer>();
            if (skinned == null || skinned.sharedMesh == null) return null;
            return skinned.sharedMesh = Instantiate(skinned.sharedMesh);
        }

        void LateUpdate()
        {
            if (Time.deltaTime <= 0) return;
            // Unity's z looks the other way round the x axis: (x, y, z) of glTF is (-x, y, z) here.
            Matrix4x4 world = Matrix4x4.TRS(transform.position, transform.rotation, Vector3.one);
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    place[4 * column + row] = world[row, column] * ((row == 0) != (column == 0) ? -1 : 1);
            Face.MoveHead(place, inertia);
            Face.Step(Time.deltaTime);
            foreach (Part part in bound)
            {
                Face.WritePositions(part.index, part.numbers);
                Unpack(part.numbers, part.positions);
                Face.WriteNormals(part.index, part.numbers);
                Unpack(part.numbers, part.normals);
                part.mesh.vertices = part.positions;
                part.mesh.normals = part.normals;
                part.mesh.RecalculateBounds();
            }
        }

        static void Unpack(float[] numbers, Vector3[] to)
        {
            for (int v = 0; v < to.Length; ++v) to[v] = new Vector3(-numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]);
        }

        void OnDestroy()
        {
            if (Face != null) Face.Dispose();
            if (Asset != null) Asset.Dispose();
        }
    }
}
